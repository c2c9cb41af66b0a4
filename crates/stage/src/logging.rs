//! Messages to standard error.

use std::fmt;

use tracing::{Event, Level, Subscriber, level_filters::LevelFilter};
use tracing_subscriber::filter::Targets;
use tracing_subscriber::fmt::format::Writer;
use tracing_subscriber::fmt::{FmtContext, FormatEvent, FormatFields};
use tracing_subscriber::layer::SubscriberExt as _;
use tracing_subscriber::registry::LookupSpan;
use tracing_subscriber::util::SubscriberInitExt as _;
use tracing_subscriber::{Layer as _, registry};

use crate::{CommonArguments, doubt};

/// Formats messages like other command-line tools: `posecut-pcm: warning: …`.
struct CommandLine {
    program: &'static str,
}

impl<S, N> FormatEvent<S, N> for CommandLine
where
    S: Subscriber + for<'a> LookupSpan<'a>,
    N: for<'a> FormatFields<'a> + 'static,
{
    fn format_event(
        &self,
        context: &FmtContext<'_, S, N>,
        mut writer: Writer<'_>,
        event: &Event<'_>,
    ) -> fmt::Result {
        let level = match *event.metadata().level() {
            Level::ERROR => "error: ",
            Level::WARN => "warning: ",
            _ => "",
        };
        write!(writer, "posecut-{}: {level}", self.program)?;
        context.field_format().format_fields(writer.by_ref(), event)?;
        writeln!(writer)
    }
}

pub(crate) fn install(program: &'static str, common: &CommonArguments) {
    let level = if common.quiet {
        LevelFilter::ERROR
    } else if common.verbose {
        LevelFilter::DEBUG
    } else {
        LevelFilter::INFO
    };
    let filter = Targets::new().with_default(level).with_target(doubt::TARGET, level.max(LevelFilter::WARN));
    // A second subscriber in one process (tests) is no error: the first one stays.
    let messages = tracing_subscriber::fmt::layer()
        .with_writer(std::io::stderr)
        .event_format(CommandLine { program })
        .with_filter(filter);
    let _ = registry().with(messages).try_init();
}
