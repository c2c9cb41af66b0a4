#!/bin/sh
# Part of scripts/fetch-nclt.sh: what there is to fetch, and how much.
# shellcheck disable=SC2154 # The script sets base and directory, and initialises the lists.

# Adds the files of a session to the plan (DATE|PATH|SIZE|BYTES_LEFT), or the session to those that failed.
plan_session() { # date
    for path in "ground_truth/groundtruth_$1.csv" "covariance/cov_$1.csv" "sensor_data/$1_sen.tar.gz"; do
        plan_file "$1" "$path" || {
            failed="$failed $1"
            break
        }
    done
}

plan_file() { # date path
    name=${2##*/}
    status=0
    answer=$(ask "$base/$2") || status=$?
    if [ "$status" -ne 0 ]; then
        complain "error: $base: $(reason $status)"
        case $status in
        6 | 7) # Nothing else will do better.
            complain "failed:$dates"
            exit 1
            ;;
        esac
        return 1
    fi
    code=${answer%% *}
    size=${answer#* }
    case $code:$name in
    404:cov_* | 403:cov_*)
        say "  $name: not on the server; posecut does not need it"
        return 0
        ;;
    404:* | 403:*)
        complain "$name: the server has no such file (status $code); --help lists the sessions"
        return 1
        ;;
    2??:*) ;;
    *)
        complain "$name: the server answers with status $code; try again later"
        return 1
        ;;
    esac
    have=$(size_of "$directory/$name")
    if [ "$have" -gt 0 ] && { [ -z "$size" ] || [ "$have" = "$size" ]; }; then
        say "  $name: $(human "$have"), already there"
        return 0
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
    plan="$plan $1|$2|$size|$left"
}

# Leaves sessions that lack a file out of the plan, and says how much the others are.
sum_up() {
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
}

# Whether the folder can hold it, and whether the user wants it.
may_download() {
    if ! mkdir -p "$directory" || [ ! -w "$directory" ]; then
        complain "error: $directory: cannot be written; name another directory with -o"
        return 1
    fi
    free=$(df -Pk "$directory" 2>/dev/null | awk 'NR == 2 { printf "%.0f", $4 * 1024 }')
    if [ -n "$free" ] && [ "$free" -lt "$total" ]; then
        complain "error: $directory: only $(human "$free") are free; name another directory with -o, or fetch fewer sessions"
        return 1
    fi
    [ "$confirmed" = no ] && [ -t 0 ] || return 0
    printf 'Go on? [y/N] '
    read -r reply || reply=
    case $reply in
    [yY]*) ;;
    *)
        say "Nothing was downloaded."
        return 1
        ;;
    esac
}

# Fetches what the plan has; the rest of a session that failed is left out.
download() {
    for entry in $plan; do
        date=${entry%%|*}
        rest=${entry#*|}
        path=${rest%%|*}
        size=${rest#*|}
        size=${size%|*}
        case " $failed " in *" $date "*) continue ;; esac
        fetch "$base/$path" "$directory/${path##*/}" "$size" || failed="$failed $date"
    done
}
