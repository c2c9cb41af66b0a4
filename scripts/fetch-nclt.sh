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

help() {
    cat <<HELP
Download sessions of the NCLT dataset.

Usage: scripts/$program [-o DIR] [-n] [-y] DATE...

  DATE     a session, YYYY-MM-DD, such as the four of the paper:
           2012-01-22 2012-03-31 2012-08-04 2012-11-17
  -o DIR   where the files go [default: data/nclt]
  -n       print what would be downloaded and how large it is, and stop
  -y       do not ask before downloading (nor is asked where no terminal is there to answer)
  --help   print this

Of each session it fetches the ground truth, the covariances of the ground truth and the sensor archive (not the
images), and leaves them as DIR/groundtruth_DATE.csv, DIR/cov_DATE.csv and DIR/DATE_sen.tar.gz, which is where
'make table NCLT=DIR' and posecut-ingest look for them.

What is there already is not fetched again, and what was interrupted goes on where it stopped (FILE.part). A file
gets its name only after its size, its compression and its columns have been checked.

POSECUT_NCLT_URL names another server with the same folders (ground_truth/, covariance/, sensor_data/); the default
is $default_url.

NCLT's sessions: 2012-01-08 2012-01-15 2012-01-22 2012-02-02 2012-02-04 2012-02-05 2012-02-12 2012-02-18 2012-02-19
2012-03-17 2012-03-25 2012-03-31 2012-04-29 2012-05-11 2012-05-26 2012-06-15 2012-08-04 2012-08-20 2012-09-28
2012-10-28 2012-11-04 2012-11-16 2012-11-17 2012-12-01 2013-01-10 2013-02-23 2013-04-05

NCLT is by Carlevaris-Bianco, Ushani and Eustice (IJRR 35(9), 2016), under the Open Database License 1.0.

Exit status: 0 all there, 1 something could not be fetched, 2 the command line is wrong.
HELP
}

say() { printf '%s\n' "$*"; }
complain() { printf '%s: %s\n' "$program" "$*" >&2; }
usage_error() {
    complain "error: $1"
    exit 2
}

# Bytes in a form that people read.
human() {
    awk -v bytes="$1" 'BEGIN {
        split("B kB MB GB TB", unit, " ")
        for (i = 1; bytes >= 1000 && i < 5; i++) bytes /= 1000
        printf (i == 1 ? "%d %s" : "%.1f %s"), bytes, unit[i]
    }'
}

size_of() {
    if [ -f "$1" ]; then wc -c <"$1" | tr -d ' '; else echo 0; fi
}

is_date() {
    case $1 in
    [0-9][0-9][0-9][0-9]-0[1-9]-[0-3][0-9] | [0-9][0-9][0-9][0-9]-1[0-2]-[0-3][0-9]) ;;
    *) return 1 ;;
    esac
    case $1 in
    *-00 | *-3[2-9]) return 1 ;;
    esac
}

# What went wrong, by curl's exit status.
reason() {
    case $1 in
    6) echo "the name of the server cannot be resolved; check the network, or name a mirror with POSECUT_NCLT_URL" ;;
    7) echo "the server does not answer; check the network, or name a mirror with POSECUT_NCLT_URL" ;;
    22) echo "the server does not give the file; try again later" ;;
    18) echo "the connection ended early; run the script again to go on from there" ;;
    23) echo "the file cannot be written; is the disk full?" ;;
    28) echo "the server was silent for too long; run the script again to go on from there" ;;
    35 | 51 | 58 | 60 | 77) echo "no secure connection (curl exit status $1); check the system's certificates and clock" ;;
    *) echo "curl exit status $1; 'man curl' says what that means" ;;
    esac
}

# Prints "STATUS SIZE" of a URL, SIZE being empty if the server does not tell; fails as curl does.
ask() {
    headers=$(curl --silent --head --location --connect-timeout 20 --max-time 60 "$1") || return $?
    printf '%s\n' "$headers" | tr -d '\r' | awk '
        /^HTTP\// { status = $2; size = "" }
        tolower($1) == "content-length:" { size = $2 }
        END { print status, size }'
}

# curl to a .part file, with a bar where somebody sees it.
transfer() {
    if [ -t 2 ]; then bar=--progress-bar; else bar='--silent --show-error'; fi
    # shellcheck disable=SC2086 # two options in one variable
    curl --fail --location $bar --connect-timeout 20 --speed-limit 1 --speed-time 60 "$@"
}

# Whether a downloaded file is whole; says why not.
is_sound() { # file name expected-size
    found=$(size_of "$1")
    if [ -n "$3" ] && [ "$found" -ne "$3" ]; then
        complain "$2: has $found bytes, and the server says $3"
        return 1
    fi
    case $2 in
    *.gz)
        if ! gzip -t "$1" 2>/dev/null; then
            complain "$2: is no sound gzip archive"
            return 1
        fi
        ;;
    groundtruth_*) has_columns "$1" "$2" 7 ;;
    cov_*) has_columns "$1" "$2" 22 ;;
    esac
}

has_columns() { # file name columns
    fault=$(awk -F, -v columns="$3" '
        NF != columns { print "line " NR ": expected " columns " columns, found " NF; exit }
        $1 !~ /^[ \t]*[0-9][0-9.eE+]*[ \t]*$/ { print "line " NR ": \"" $1 "\" is no time in microseconds"; exit }
        END { if (NR == 0) print "is empty" }' "$1")
    [ -z "$fault" ] && return 0
    complain "$2: $fault"
    return 1
}

# Fetches a URL into a file; an expected size may be empty.
fetch() { # url file expected-size
    name=$(basename "$2")
    part=$2.part
    for attempt in 1 2; do
        have=$(size_of "$part")
        if [ -n "$3" ] && [ "$have" -gt "$3" ]; then
            rm -f "$part"
            have=0
        fi
        status=0
        if [ "$have" -gt 0 ] && [ "$have" = "$3" ]; then
            say "  $name: was fetched before, checking it"
        elif [ "$have" -gt 0 ]; then
            say "  $name: going on after $(human "$have")"
            transfer --continue-at - --output "$part" "$1" || status=$?
            case $status in
            22 | 33 | 36) # The server cannot go on in the middle.
                say "  $name: the server starts over"
                have=0 status=0
                transfer --output "$part" "$1" || status=$?
                ;;
            esac
        else
            say "  $name"
            transfer --output "$part" "$1" || status=$?
        fi
        if [ "$status" -ne 0 ]; then
            complain "$name: $(reason $status)"
            return 1
        fi
        if is_sound "$part" "$name" "$3"; then
            mv -f "$part" "$2"
            return
        fi
        rm -f "$part"
        # A whole download that is unsound will be so again; one pieced together may not.
        if [ "$have" -eq 0 ] || [ "$attempt" -eq 2 ]; then break; fi
        say "  $name: once more from the start"
    done
    complain "$name: is damaged on the server, or on the way; nothing was kept of it"
    return 1
}

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
for date in $dates; do
    for path in "ground_truth/groundtruth_$date.csv" "covariance/cov_$date.csv" "sensor_data/${date}_sen.tar.gz"; do
        name=${path##*/}
        status=0
        answer=$(ask "$base/$path") || status=$?
        if [ "$status" -ne 0 ]; then
            complain "error: $base: $(reason $status)"
            case $status in
            6 | 7) # Nothing else will do better.
                complain "failed:$dates"
                exit 1
                ;;
            esac
            failed="$failed $date"
            break
        fi
        code=${answer%% *}
        size=${answer#* }
        if [ "$code" = 404 ] || [ "$code" = 403 ]; then
            case $name in
            cov_*)
                say "  $name: not on the server; posecut does not need it"
                continue
                ;;
            esac
            complain "$name: the server has no such file (status $code); --help lists the sessions"
            failed="$failed $date"
            break
        fi
        case $code in
        2??) ;;
        *)
            complain "$name: the server answers with status $code; try again later"
            failed="$failed $date"
            break
            ;;
        esac
        have=$(size_of "$directory/$name")
        if [ "$have" -gt 0 ] && { [ -z "$size" ] || [ "$have" = "$size" ]; }; then
            say "  $name: $(human "$have"), already there"
            continue
        fi
        left=0
        if [ -z "$size" ]; then
            say "  $name: size unknown"
        else
            left=$size
            have=$(size_of "$directory/$name.part")
            note=
            if [ "$have" -gt 0 ] && [ "$have" -le "$size" ]; then
                left=$((size - have))
                note=", of which $(human "$have") are there"
            fi
            say "  $name: $(human "$size")$note"
        fi
        plan="$plan $date|$path|$size|$left"
    done
done

# A session that lacks a file is not fetched in parts.
kept=
total=0
more=
for entry in $plan; do
    case " $failed " in *" ${entry%%|*} "*) continue ;; esac
    kept="$kept $entry"
    total=$((total + ${entry##*|}))
    case $entry in *"||"*) more=' and files of unknown size' ;; esac
done
plan=$kept

say "To download: $(human "$total")$more, into $directory"

if [ "$only_print" = no ] && [ -n "$plan" ]; then
    if ! mkdir -p "$directory" || [ ! -w "$directory" ]; then
        complain "error: $directory: cannot be written; name another directory with -o"
        exit 1
    fi
    free=$(df -Pk "$directory" 2>/dev/null | awk 'NR == 2 { printf "%.0f", $4 * 1024 }')
    if [ -n "$free" ] && [ "$free" -lt "$total" ]; then
        complain "error: $directory: only $(human "$free") are free; name another directory with -o, or fetch fewer sessions"
        exit 1
    fi
    if [ "$confirmed" = no ] && [ -t 0 ]; then
        printf 'Go on? [y/N] '
        read -r reply || reply=
        case $reply in
        [yY]*) ;;
        *)
            say "Nothing was downloaded."
            exit 1
            ;;
        esac
    fi
    for entry in $plan; do
        date=${entry%%|*}
        rest=${entry#*|}
        path=${rest%%|*}
        size=${rest#*|}
        size=${size%|*}
        case " $failed " in *" $date "*) continue ;; esac
        fetch "$base/$path" "$directory/${path##*/}" "$size" || failed="$failed $date"
    done
fi

# ---- what came of it ---------------------------------------------------------------------------------------
if [ -n "$failed" ]; then
    complain "failed:$failed"
    exit 1
fi
if [ "$only_print" = no ]; then
    say "All there. Next: make table NCLT=$directory SESSIONS=\"${dates# }\""
fi
