#!/bin/sh
# Part of scripts/fetch-nclt.sh: asks for files and fetches them.
# shellcheck disable=SC2154 # The script sets program, base and directory.

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
