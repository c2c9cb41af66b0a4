//! Changes that keep the look of a format: numbers become hostile numbers, lines and words move, brackets nest.

use posecut_stage::ChaCha8Rng;
use rand::RngExt as _;

/// Numbers that are critical for arithmetic: zeros, limits of integers and floats, subnormals, powers of two, and the
/// number notations of other languages.
const NUMBERS: &[&str] = &[
    "0",
    "-0",
    "-0.0",
    "1",
    "-1",
    "2",
    "3",
    "0.5",
    "1e-9",
    "1e-300",
    "5e-324",
    "1e15",
    "1e18",
    "1e100",
    "1e154",
    "1e155",
    "-1e155",
    "1e300",
    "1.7976931348623157e308",
    "-1.7976931348623157e308",
    "1e309",
    "-1e309",
    "1e999",
    "NaN",
    "nan",
    "inf",
    "-inf",
    "Infinity",
    "null",
    "true",
    "\"\"",
    "[]",
    "{}",
    "127",
    "128",
    "255",
    "256",
    "65535",
    "65536",
    "268435455",
    "268435456",
    "2147483647",
    "2147483648",
    "-2147483648",
    "4294967295",
    "4294967296",
    "9007199254740991",
    "9007199254740993",
    "9000000000000000",
    "9223372036854775807",
    "9223372036854775808",
    "-9223372036854775808",
    "-9223372036854775809",
    "18446744073709551615",
    "18446744073709551616",
    "1000000000000000000",
    "7061644215716937728",
    "0x10",
    "1_000",
    "+1",
    "01",
    ".5",
    "5.",
    "1e",
    "3.141592653589793",
    "-3.141592653589793",
    "3.1415926535897936",
    "6.283185307179586",
    "0.7071067811865476",
    "1000000",
];

/// Applies one to eight changes. Words, lines and stretches are borrowed from `other`.
pub fn mutate(input: &mut Vec<u8>, other: &[u8], words: &[&str], random: &mut ChaCha8Rng) {
    let rounds = 1 + (random.random_range(0..8_u32) * random.random_range(0..8_u32)) / 7;
    for _ in 0..rounds {
        match random.random_range(0..16_u32) {
            0..=4 => replace_number(input, random),
            5 | 6 => replace_word(input, words, random),
            7 => delete(input, &lines(input), random),
            8 => duplicate(input, &lines(input), random),
            9 => swap(input, &lines(input), random),
            10 => delete(input, &tokens(input, |_| true), random),
            11 => swap(input, &tokens(input, |_| true), random),
            12 => splice(input, other, random),
            13 => nest(input, random),
            14 => truncate(input, random),
            _ => flip(input, random),
        }
    }
}

type Range = std::ops::Range<usize>;

fn is_separator(byte: u8) -> bool {
    byte.is_ascii_whitespace() || b",:[]{}\"=/".contains(&byte)
}

fn tokens(input: &[u8], keep: impl Fn(&[u8]) -> bool) -> Vec<Range> {
    let mut tokens = Vec::new();
    let mut start = None;
    for (place, &byte) in input.iter().chain(b" ").enumerate() {
        match (is_separator(byte), start) {
            (false, None) => start = Some(place),
            (true, Some(first)) => {
                if keep(&input[first..place]) {
                    tokens.push(first..place);
                }
                start = None;
            }
            _ => {}
        }
    }
    tokens
}

fn lines(input: &[u8]) -> Vec<Range> {
    let mut lines = Vec::new();
    let mut start = 0;
    for line in input.split_inclusive(|&byte| byte == b'\n') {
        lines.push(start..start + line.len());
        start += line.len();
    }
    lines
}

fn pick<'a, T>(choices: &'a [T], random: &mut ChaCha8Rng) -> Option<&'a T> {
    (!choices.is_empty()).then(|| &choices[random.random_range(0..choices.len())])
}

fn replace(input: &mut Vec<u8>, range: Range, by: &[u8]) {
    input.splice(range, by.iter().copied());
}

fn replace_number(input: &mut Vec<u8>, random: &mut ChaCha8Rng) {
    let numbers = tokens(input, |token| {
        token[0].is_ascii_digit() || (b"-.".contains(&token[0]) && token.iter().any(u8::is_ascii_digit))
    });
    let Some(place) = pick(&numbers, random).cloned() else { return };
    // Half of the time, take a number from elsewhere in the file: matching ids get deeper into a reader than unknown ones.
    if random.random::<bool>() {
        if let Some(number) = pick(NUMBERS, random) {
            replace(input, place, number.as_bytes());
        }
    } else if let Some(from) = pick(&numbers, random).cloned() {
        let number = input[from].to_vec();
        replace(input, place, &number);
    }
}

fn replace_word(input: &mut Vec<u8>, words: &[&str], random: &mut ChaCha8Rng) {
    let places = tokens(input, |token| token[0].is_ascii_alphabetic());
    if let (Some(place), Some(word)) = (pick(&places, random).cloned(), pick(words, random)) {
        replace(input, place, word.as_bytes());
    }
}

fn delete(input: &mut Vec<u8>, pieces: &[Range], random: &mut ChaCha8Rng) {
    if let Some(piece) = pick(pieces, random).cloned() {
        replace(input, piece, b"");
    }
}

fn duplicate(input: &mut Vec<u8>, pieces: &[Range], random: &mut ChaCha8Rng) {
    if let (Some(piece), Some(place)) = (pick(pieces, random).cloned(), pick(pieces, random)) {
        let copy = input[piece].to_vec();
        replace(input, place.start..place.start, &copy);
    }
}

fn swap(input: &mut Vec<u8>, pieces: &[Range], random: &mut ChaCha8Rng) {
    if let (Some(first), Some(second)) = (pick(pieces, random), pick(pieces, random)) {
        let (first, second) = if first.start <= second.start { (first, second) } else { (second, first) };
        if first != second {
            let (early, late) = (input[first.clone()].to_vec(), input[second.clone()].to_vec());
            replace(input, second.clone(), &early);
            replace(input, first.clone(), &late);
        }
    }
}

fn splice(input: &mut Vec<u8>, other: &[u8], random: &mut ChaCha8Rng) {
    let (here, there) = (lines(input), lines(other));
    if let (Some(place), Some(piece)) = (pick(&here, random).cloned(), pick(&there, random).cloned()) {
        let end = if random.random::<bool>() { place.start } else { place.end };
        replace(input, place.start..end, &other[piece]);
    }
}

fn nest(input: &mut Vec<u8>, random: &mut ChaCha8Rng) {
    let places = tokens(input, |_| true);
    let Some(place) = pick(&places, random) else { return };
    let depth = [1, 2, 100, 127, 128, 129, 5_000][random.random_range(0..7_usize)];
    let opening: &[u8] = [&b"["[..], b"{\"a\":"][random.random_range(0..2_usize)];
    replace(input, place.start..place.start, &opening.repeat(depth));
}

fn truncate(input: &mut Vec<u8>, random: &mut ChaCha8Rng) {
    let length = random.random_range(0..=input.len());
    input.truncate(length);
}

fn flip(input: &mut Vec<u8>, random: &mut ChaCha8Rng) {
    const STRETCHES: &[&[u8]] = &[
        b"\0",
        b"\xff",
        b"\xef\xbb\xbf",
        b"\r\n",
        b"\r",
        b"\n",
        b"\"",
        b"\\",
        b"\\u0000",
        b"#",
        b" ",
        b"\xc3",
    ];
    if input.is_empty() {
        return;
    }
    let place = random.random_range(0..input.len());
    if random.random::<bool>() {
        input[place] ^= 1 << random.random_range(0..8_u32);
    } else if let Some(stretch) = pick(STRETCHES, random) {
        replace(input, place..place, stretch);
    }
}
