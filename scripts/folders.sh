#!/bin/sh
# folders.sh mark DIR…: creates folders for results, each with a marker file. A folder with other content does not change.
# folders.sh clean DIR…: deletes folders that have the marker, and nothing else.
set -u
marker=.posecut-made
task=$1
shift
status=0
for folder do
  case $task in
    mark)
      if [ ! -d "$folder" ] || [ -z "$(ls -A -- "$folder")" ]; then
        mkdir -p -- "$folder" && : >"$folder/$marker" || exit 2
      fi ;;
    clean)
      if [ -L "$folder" ]; then
        echo "$folder: is a link, and stays; delete it yourself"
        status=2
      elif [ -f "$folder/$marker" ]; then
        rm -rf -- "$folder"
      elif [ -e "$folder" ]; then
        echo "$folder: has no $marker, so it was not made by make, and stays; delete it yourself"
        status=2
      fi ;;
    *) echo "folders.sh: \"$task\" is neither mark nor clean"; exit 2 ;;
  esac
done
exit $status
