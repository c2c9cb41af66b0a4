#!/bin/sh
# Downloads NCLT sessions from the public archive; `--help` tells how.
set -u

program=fetch-nclt.sh
default_url=https://s3.us-east-2.amazonaws.com/nclt.perl.engin.umich.edu
base=${POSECUT_NCLT_URL:-$default_url}
base=${base%/}
directory=data/nclt
only_print=no
confirmed=no

parts=$(dirname "$0")/nclt
# shellcheck source=scripts/nclt/words.sh
. "$parts/words.sh"
# shellcheck source=scripts/nclt/checks.sh
. "$parts/checks.sh"
# shellcheck source=scripts/nclt/transfer.sh
. "$parts/transfer.sh"
# shellcheck source=scripts/nclt/plan.sh
. "$parts/plan.sh"

# ---- command line ------------------------------------------------------------------------------------------
dates=
while [ $# -gt 0 ]; do
    case $1 in
    -h | --help)
        help
        exit 0
        ;;
    -o)
        [ $# -ge 2 ] || usage_error "-o needs a directory"
        [ -n "$2" ] || usage_error "-o needs a directory, and its name is empty"
        directory=$2
        shift
        ;;
    -n) only_print=yes ;;
    -y) confirmed=yes ;;
    -*) usage_error "unknown option $1; --help lists them" ;;
    *)
        is_date "$1" || usage_error "\"$1\" is no date; sessions are named YYYY-MM-DD, and --help lists them"
        case " $dates " in *" $1 "*) ;; *) dates="$dates $1" ;; esac
        ;;
    esac
    shift
done
if [ -z "$dates" ]; then
    help >&2
    exit 2
fi
for tool in curl gzip awk; do
    command -v "$tool" >/dev/null 2>&1 || usage_error "$tool is needed and not installed"
done
trap 'complain "interrupted; run the same command again to go on"; exit 130' INT TERM

# ---- what there is to fetch --------------------------------------------------------------------------------
plan=
failed=
say "From $base:"
for date in $dates; do plan_session "$date"; done
sum_up
if [ "$only_print" = no ] && [ -n "$plan" ]; then
    may_download || exit 1
    download
fi

# ---- what came of it ---------------------------------------------------------------------------------------
if [ -n "$failed" ]; then
    complain "failed:$failed"
    exit 1
fi
if [ "$only_print" = no ]; then
    say "All there. Next: make table NCLT=$directory SESSIONS=\"${dates# }\""
fi
