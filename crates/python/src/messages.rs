//! Messages of stages, collected for Python instead of printed.

use std::fmt::{Debug, Write as _};
use std::sync::{Arc, Mutex, PoisonError};

use tracing::field::{Field, Visit};
use tracing::level_filters::LevelFilter;
use tracing::span::{Attributes, Id, Record};
use tracing::subscriber::with_default;
use tracing::{Event, Level, Metadata, Subscriber};

/// The target of the warnings about doubts (crates/stage).
const DOUBT: &str = "posecut::doubt";

/// The kind of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Information,
    Warning,
    Doubt,
}

impl Kind {
    /// The name that Python reads.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Information => "information",
            Self::Warning => "warning",
            Self::Doubt => "doubt",
        }
    }
}

/// Messages in the order in which they were given.
pub(crate) type Messages = Vec<(Kind, String)>;

/// Runs work in this thread and collects its messages.
pub(crate) fn collected<T>(work: impl FnOnce() -> T) -> (T, Messages) {
    let collector = Collector::default();
    let messages = Arc::clone(&collector.messages);
    let value = with_default(collector, work);
    let mut messages = messages.lock().unwrap_or_else(PoisonError::into_inner);
    (value, std::mem::take(&mut *messages))
}

#[derive(Default)]
struct Collector {
    messages: Arc<Mutex<Messages>>,
}

impl Subscriber for Collector {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        metadata.is_event() && *metadata.level() <= Level::INFO && metadata.target().starts_with("posecut")
    }

    fn max_level_hint(&self) -> Option<LevelFilter> {
        Some(LevelFilter::INFO)
    }

    fn event(&self, event: &Event<'_>) {
        let metadata = event.metadata();
        let kind = match *metadata.level() {
            _ if metadata.target() == DOUBT => Kind::Doubt,
            Level::INFO => Kind::Information,
            _ => Kind::Warning,
        };
        let mut text = Text::default();
        event.record(&mut text);
        self.messages.lock().unwrap_or_else(PoisonError::into_inner).push((kind, text.0));
    }

    // Stages have no spans.
    fn new_span(&self, _: &Attributes<'_>) -> Id {
        Id::from_u64(1)
    }

    fn record(&self, _: &Id, _: &Record<'_>) {}

    fn record_follows_from(&self, _: &Id, _: &Id) {}

    fn enter(&self, _: &Id) {}

    fn exit(&self, _: &Id) {}
}

#[derive(Default)]
struct Text(String);

impl Visit for Text {
    fn record_debug(&mut self, field: &Field, value: &dyn Debug) {
        if field.name() == "message" {
            // Writing to a string cannot fail.
            let _ = write!(self.0, "{value:?}");
        }
    }
}
