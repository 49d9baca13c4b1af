# Sourced by the scripts that run every shipped scene on 1, 2, 4 and 9 nodes: how each is cut into regions.
# shellcheck shell=bash

# Metres: so small that bodies change hosts.
declare -A cell=([card_house]=6 [columns_rain]=15 [corner_stacks]=6 [demo]=12 [domino_line]=20 [falling_piles]=8
  [island]=10 [newtons_cradle]=6 [ragdoll_stairs]=6 [three_way]=8 [tower]=8 [tug_of_war]=10 [two_spheres]=10
  [sorting_hall]=8 [vehicle_tour]=9 [far_out]=6)

# The overrides that cut a scene into so many regions, one per line.
regions_of() {
  local scene=$1 nodes=$2 side=${cell[$1]}
  if [[ $scene == far_out ]]; then
    local rows=1 columns=2 boxes=() row column
    case $nodes in 1) columns=1 ;; 4) rows=2 ;; 9) rows=3 columns=3 ;; esac
    for ((row = 0; row < rows; ++row)); do
      for ((column = 0; column < columns; ++column)); do
        boxes+=("[$((99999 + 6 * (column - columns / 2))), $((6 * (row - rows / 2))), $((99999 + 6 * (column - columns / 2 + 1))), $((6 * (row - rows / 2 + 1)))]")
      done
    done
    local joined
    printf -v joined '%s, ' "${boxes[@]}"
    printf 'regions={layout: boxes, boxes: [%s]}\n' "${joined%, }"
    return
  fi
  case $nodes in
    1) printf 'regions={layout: columns, count: 1, width: %s}\n' "$side" ;;
    2) printf 'regions={layout: columns, count: 2, width: %s}\n' "$side" ;;
    4) printf 'regions={layout: grid, rows: 2, columns: 2, cell: [%s, %s]}\n' "$side" "$side" ;;
    9) printf 'regions={layout: grid, rows: 3, columns: 3, cell: [%s, %s]}\n' "$side" "$side" ;;
  esac
}
