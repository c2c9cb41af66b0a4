#!/bin/sh
# Part of scripts/fetch-nclt.sh: what it says, and how.
# shellcheck disable=SC2154 # The script sets program, base and directory.

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
