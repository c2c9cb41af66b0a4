# shellcheck shell=sh
# Part of the pipelines of this folder: reads the options before their files.
# A pipeline sets `stages` and `others`, and sources this file. The variable of a stage NAME is then the program of --NAME PROGRAM, or
# posecut-NAME of target/release. The variable of another option is its value, or /dev/null.
# shellcheck disable=SC2154 # The pipeline sets stages and others.
for name in $stages; do
  eval "$name=\$(dirname \"\$0\")/../target/release/posecut-$name"
done
for name in $others; do
  eval "$name=/dev/null"
done
while [ $# -gt 1 ]; do
  # A word without dashes is a file, also if it has the name of a stage.
  case $1 in --?*) name=${1#--} ;; *) break ;; esac
  case " $stages $others " in *" $name "*) ;; *) break ;; esac
  eval "$name=\$2"
  shift 2
done
if [ "${1:-}" = --version ]; then
  echo "$(basename "$0") 0.1.0"
  exit
fi
