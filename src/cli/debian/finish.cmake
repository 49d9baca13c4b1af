# Between installing and packing (CPACK_PRE_BUILD_SCRIPTS): what Debian has elsewhere, or compressed.
set(aurasim ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/Unspecified)
set(version ${CPACK_PACKAGE_VERSION})
string(TIMESTAMP now "%a, %d %b %Y %H:%M:%S +0000" UTC)

function(compress file)
  execute_process(COMMAND gzip -9nf ${file} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

# As dpkg reads it; what a user notices is in the file beside it.
function(write_changelog folder package)
  file(WRITE ${folder}/changelog
    "${package} (${version}) bookworm; urgency=medium\n\n"
    "  * See /usr/share/doc/aurasim/CHANGELOG.md.gz.\n\n"
    " -- ${CPACK_DEBIAN_PACKAGE_MAINTAINER}  ${now}\n")
  compress(${folder}/changelog)
endfunction()

file(MAKE_DIRECTORY ${aurasim}/etc/aurasim ${aurasim}/usr/lib/systemd/system)
file(RENAME ${aurasim}/usr/share/aurasim/systemd/node.env ${aurasim}/etc/aurasim/node.env)
file(GLOB units ${aurasim}/usr/share/aurasim/systemd/*.service)
foreach(unit ${units})
  file(COPY ${unit} DESTINATION ${aurasim}/usr/lib/systemd/system)
endforeach()
file(REMOVE_RECURSE ${aurasim}/usr/share/aurasim/systemd)

compress(${aurasim}/usr/share/man/man1/aurasim.1)
compress(${aurasim}/usr/share/doc/aurasim/CHANGELOG.md)
write_changelog(${aurasim}/usr/share/doc/aurasim aurasim)
file(COPY ${CMAKE_CURRENT_LIST_DIR}/copyright DESTINATION ${aurasim}/usr/share/doc/aurasim)

foreach(part import/aurasim-import dev/libaurasim-dev python/python3-aurasim)
  cmake_path(GET part PARENT_PATH component)
  cmake_path(GET part FILENAME package)
  set(folder ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/${component})
  if(EXISTS ${folder})
    file(MAKE_DIRECTORY ${folder}/usr/share/doc/${package})
    write_changelog(${folder}/usr/share/doc/${package} ${package})
    file(COPY ${CMAKE_CURRENT_LIST_DIR}/copyright DESTINATION ${folder}/usr/share/doc/${package})
  endif()
endforeach()
set(import ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/import)
if(EXISTS ${import})
  file(MAKE_DIRECTORY ${import}/usr/share/man/man1)
  file(CREATE_LINK aurasim.1.gz ${import}/usr/share/man/man1/aurasim-import.1.gz SYMBOLIC)
endif()
