//! The examples of a program, for its long help and its manual page.

use std::fmt::Write as _;

use clap_mangen::roff::{Roff, roman};

/// The examples of a program: for each one a sentence that says what it does, and a command line.
///
/// A command line may have several lines. Each of them must fit into 76 columns, because help is indented and terminals have 80.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Examples(pub &'static [(&'static str, &'static str)]);

impl Examples {
    /// The section of the help, or nothing without examples.
    #[must_use]
    pub fn help(self) -> String {
        let mut text = String::new();
        for (index, (sentence, line)) in self.0.iter().enumerate() {
            text.push_str(if index == 0 { "Examples:\n" } else { "\n" });
            let _ = writeln!(text, "  {sentence}:");
            for part in line.lines() {
                let _ = writeln!(text, "    {part}");
            }
        }
        text
    }

    /// The section of the manual page, or nothing without examples.
    #[must_use]
    pub fn manual(self) -> String {
        if self.0.is_empty() {
            return String::new();
        }
        let mut page = Roff::new();
        page.control("SH", ["EXAMPLES"]);
        for (sentence, line) in self.0 {
            page.control("PP", []).text([roman(format!("{sentence}:"))]);
            // Indented, and with the line breaks of the example.
            page.control("RS", ["4"]).control("nf", []);
            for part in line.lines() {
                page.text([roman(part)]);
            }
            page.control("fi", []).control("RE", []);
        }
        page.render()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOME: Examples =
        Examples(&[("Do this", "posecut pcm a.jsonl |\n    posecut verify"), ("Do that", ".\\run 'x'")]);

    #[test]
    fn help_indents_every_line() {
        assert_eq!(
            SOME.help(),
            "Examples:\n  Do this:\n    posecut pcm a.jsonl |\n        posecut verify\n\n  Do that:\n    .\\run 'x'\n"
        );
        assert_eq!(Examples::default().help(), "");
    }

    /// A line that starts with a point would be a request of roff and vanish.
    #[test]
    fn the_manual_escapes_what_roff_would_interpret() {
        let page = SOME.manual();
        assert!(page.contains(".SH EXAMPLES\n.PP\nDo this:\n.RS 4\n.nf\n"), "{page}");
        assert!(page.contains("\n\\&.\\\\run \\*(Aqx\\*(Aq\n.fi\n.RE\n"), "{page}");
        assert_eq!(Examples::default().manual(), "");
    }
}
