#!/bin/sh
# Part of scripts/fetch-nclt.sh: whether dates and files are as they should be.
# shellcheck disable=SC2154 # The script sets program, base and directory.

is_date() {
    case $1 in
    [0-9][0-9][0-9][0-9]-0[1-9]-[0-3][0-9] | [0-9][0-9][0-9][0-9]-1[0-2]-[0-3][0-9]) ;;
    *) return 1 ;;
    esac
    case $1 in
    *-00 | *-3[2-9]) return 1 ;;
    esac
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
