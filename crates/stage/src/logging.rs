//! Messages to standard error.

use std::fmt;

use tracing::{Event, Level, Subscriber, level_filters::LevelFilter};
use tracing_subscriber::fmt::format::Writer;
use tracing_subscriber::fmt::{FmtContext, FormatEvent, FormatFields};
use tracing_subscriber::registry::LookupSpan;

use crate::CommonArguments;

/// `posecut-pcm: warning: …`, as command-line tools speak.
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
    // A second subscriber in one process (tests) is no fault: the first one stays.
    let _ = tracing_subscriber::fmt()
        .with_max_level(level)
        .with_writer(std::io::stderr)
        .event_format(CommandLine { program })
        .try_init();
}
