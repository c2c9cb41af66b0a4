//! The statements of a certificate: reductions, packings, fixed edges, branches.

use std::io::BufRead;

use super::VerifyError;
use super::connection::Connections;
use super::part::Part;

/// Proofs with deeper nesting are rejected, because they could overflow the stack.
const DEPTH: usize = 2_000;

/// Reads a certificate line by line and checks its statements.
pub(crate) struct Checker<B> {
    lines: std::io::Lines<B>,
    line: usize,
    /// The words of the current line.
    pub(crate) words: Vec<String>,
}

impl<B: BufRead> Checker<B> {
    pub(crate) fn new(certificate: B) -> Self {
        Self { lines: certificate.lines(), line: 0, words: Vec::new() }
    }

    pub(crate) fn refute(&self, reason: String) -> VerifyError {
        VerifyError::Refuted { line: self.line, reason }
    }

    /// Goes to the next line.
    pub(crate) fn next(&mut self) -> Result<(), VerifyError> {
        self.line += 1;
        match self.lines.next() {
            None => Err(self.refute("the file ends too early".into())),
            Some(Err(cause)) => Err(VerifyError::Read { line: self.line - 1, cause }),
            Some(Ok(line)) => {
                self.words = line.split_ascii_whitespace().map(String::from).collect();
                Ok(())
            }
        }
    }

    /// The word at a position as a number.
    pub(crate) fn number<T: std::str::FromStr>(&self, place: usize) -> Result<T, VerifyError> {
        let word = self.words.get(place).map(|word| word.parse());
        word.and_then(Result::ok).ok_or_else(|| self.refute(format!("word {} is not a number", place + 1)))
    }

    /// The numbers after a keyword.
    pub(crate) fn numbers(&self, keyword: &str) -> Result<Vec<u32>, VerifyError> {
        if self.words.first().is_none_or(|word| word != keyword) {
            return Err(self.refute(format!("expected `{keyword}`")));
        }
        (1..self.words.len()).map(|place| self.number(place)).collect()
    }

    /// Checks a proof by reductions that starts at the current line `reduce`; leaves the reader on the line after it.
    pub(crate) fn reduced(&mut self, whole: Part, depth: usize) -> Result<f64, VerifyError> {
        if depth > DEPTH {
            return Err(self.refute("proofs are nested too deeply".into()));
        }
        if self.words.first().is_none_or(|word| word != "reduce") {
            return Err(self.refute("expected `reduce`".into()));
        }
        let pieces: usize = self.number(1)?;
        let mut parts: Vec<Part> = Vec::new();
        let mut whole = Some(whole);
        let mut bound = 0.0;
        self.next()?;
        for _ in 0..pieces {
            if self.words.first().is_none_or(|word| word != "piece") || self.words.len() < 2 {
                return Err(self.refute("expected `piece`".into()));
            }
            let names =
                (2..self.words.len()).map(|place| self.number(place)).collect::<Result<Vec<u32>, _>>()?;
            let mut part = if self.words[1] == "-" {
                whole
                    .take()
                    .ok_or_else(|| self.refute("only the first piece can be the whole component".into()))?
            } else {
                let parent: usize = self.number(1)?;
                let parent = parts.get_mut(parent).ok_or_else(|| VerifyError::Refuted {
                    line: self.line,
                    reason: "there is no such piece yet".into(),
                })?;
                let split = parent.split(&names);
                split.map_err(|reason| self.refute(reason))?
            };
            self.next()?;
            while self.step(&mut part)? {
                self.next()?;
            }
            if self
                .words
                .first()
                .is_some_and(|word| ["pack", "fix", "windows", "branch", "tree"].contains(&word.as_str()))
            {
                let kernel = part.take(&names).map_err(|reason| self.refute(reason))?;
                bound += self.proof(&kernel, depth)?;
            }
            parts.push(part);
        }
        // Edges that no piece took count with their negative costs.
        parts.extend(whole);
        Ok(bound + parts.iter().map(|part| part.constant + part.negative_sum()).sum::<f64>())
    }

    /// Performs the reduction that the current line states; false if it states none.
    fn step(&mut self, part: &mut Part) -> Result<bool, VerifyError> {
        let made = match self.words.first().map(String::as_str) {
            Some("i") => part.isolate(self.number(1)?),
            Some("2") => part.eliminate(self.number(1)?),
            Some("d") => part.dominance(self.number(1)?, self.number(2)?),
            Some("p") => {
                let shares = [self.number(3)?, self.number(4)?, self.number(5)?];
                part.pair(self.number(1)?, self.number(2)?, shares)
            }
            Some("t") => part.triangle(self.number(1)?, self.number(2)?, self.number(3)?),
            _ => return Ok(false),
        };
        made.map_err(|reason| self.refute(reason))?;
        Ok(true)
    }

    /// Checks the proof of a kernel's bound; leaves the reader on the line after it.
    fn proof(&mut self, kernel: &Part, depth: usize) -> Result<f64, VerifyError> {
        let integral = kernel.is_integral();
        let round = |bound: f64| {
            if integral { (bound - 1e-6 * (1.0 + bound.abs() * 1e-6)).ceil() } else { bound }
        };
        match self.words[0].as_str() {
            "pack" => {
                let conflicts = self.number(1)?;
                self.next()?;
                Ok(round(self.packing(kernel, conflicts)?.1))
            }
            "tree" => self.tree(kernel, &round),
            "fix" => {
                let (conflicts, edges): (usize, usize) = (self.number(1)?, self.number(2)?);
                let reward: f64 = self.number(3)?;
                self.check_reward(reward)?;
                self.next()?;
                let (residual, bound) = self.packing(kernel, conflicts)?;
                let mut rest = kernel.clone();
                let mut pairs = Vec::new();
                for _ in 0..edges {
                    let (tail, head): (u32, u32) = (self.number(0)?, self.number(1)?);
                    if kernel.cost(tail, head) <= 0.0 {
                        return Err(self.refute("only attractive edges can be fixed".into()));
                    }
                    pairs.push((tail, head));
                    rest.add(tail, head, reward);
                    self.next()?;
                }
                let mut proved = self.reduced(rest, depth + 1)?;
                // Who separates a pair but none before it pays at least the capacity between them.
                let mut connections = Connections::new(kernel, &residual);
                for (tail, head) in pairs {
                    proved = proved.min(round(bound + connections.flow(tail, head, proved - bound)));
                    connections.join(tail, head);
                }
                Ok(proved)
            }
            "windows" => Ok(round(self.windows(kernel, depth)?)),
            _ => {
                let (tail, head): (u32, u32) = (self.number(1)?, self.number(2)?);
                let reward: f64 = self.number(3)?;
                self.check_reward(reward)?;
                if tail == head || kernel.has(&[tail, head]).is_err() {
                    return Err(self.refute("a branch needs two nodes".into()));
                }
                self.next()?;
                // The reward is valid for any amount: a joined pair does not pay it, and a separated pair always does.
                let (mut joined, mut apart) = (kernel.clone(), kernel.clone());
                joined.add(tail, head, reward);
                apart.add(tail, head, -2.0 * reward);
                let joined = self.reduced(joined, depth + 1)?;
                let apart = self.reduced(apart, depth + 1)? + 2.0 * reward;
                Ok(joined.min(apart))
            }
        }
    }

    fn check_reward(&self, reward: f64) -> Result<(), VerifyError> {
        if reward.is_finite() && reward > 0.0 {
            Ok(())
        } else {
            Err(self.refute("a reward must be a positive number".into()))
        }
    }
}
