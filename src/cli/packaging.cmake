# What `cpack` makes Debian packages of, beside what CMakeLists.txt installs. The programs and all that they need are one
# package, aurasim. What a node's host, or its container, does without are others: aurasim-import, for its libraries,
# libaurasim-dev (src/client) and python3-aurasim (src/python).
install(FILES ${PROJECT_SOURCE_DIR}/docs/systemd/aurasim-node@.service ${PROJECT_SOURCE_DIR}/docs/systemd/aurasim-spare.service
              ${PROJECT_SOURCE_DIR}/docs/systemd/aurasim-overseer.service ${PROJECT_SOURCE_DIR}/docs/systemd/node.env
  DESTINATION share/aurasim/systemd)
install(FILES ${PROJECT_SOURCE_DIR}/CHANGELOG.md DESTINATION share/doc/aurasim)

# The rest is said when cpack runs: the top-level CMakeLists.txt, which includes CPack, sets its variables after this.
set(CPACK_PROJECT_CONFIG_FILE ${CMAKE_CURRENT_SOURCE_DIR}/debian/package.cmake PARENT_SCOPE)
