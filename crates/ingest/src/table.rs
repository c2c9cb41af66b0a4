//! CSV tables of NCLT: a time and then numbers, without a header.

use crate::IngestError;

/// The usable rows of one file, in ascending order of time.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// The file's name in messages.
    pub file: String,
    /// Microseconds UTC, strictly ascending.
    pub times: Vec<i64>,
    /// The columns after the time, row by row.
    pub rows: Vec<Vec<f64>>,
    /// Number of rows left out: rows with NaN at the start or later, and rows whose time does not advance.
    pub dropped: usize,
    /// Line of the first row left out because its time did not advance.
    pub first_reversal: Option<u64>,
    /// Line of the first row with NaN after a row without. Such a row invalidates relative measurements.
    pub first_inner_nan: Option<u64>,
}

/// If more than one row in this many goes back in time, the clock is broken: that is more than jitter.
const LARGEST_REVERSED_SHARE: usize = 100;

impl Table {
    /// Reads a table of `columns` numbers after the time. Extra columns are ignored.
    ///
    /// Rows with NaN are left out and counted (NCLT's ground truth starts with some). So are rows whose time does not
    /// advance; if they are more than one in a hundred, that is an error. A row that is too short or has a field that
    /// is not a number is an error that names its line. `parsed` receives the number of further bytes, each MiB.
    pub fn parse(
        file: &str,
        bytes: &[u8],
        columns: usize,
        parsed: &mut dyn FnMut(u64),
    ) -> Result<Self, IngestError> {
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .from_reader(bytes);
        let mut table = Self {
            file: file.to_owned(),
            times: Vec::new(),
            rows: Vec::new(),
            dropped: 0,
            first_reversal: None,
            first_inner_nan: None,
        };
        let mut reversed = 0_usize;
        let mut record = csv::ByteRecord::new();
        let mut reported = 0;
        loop {
            let more = reader.read_byte_record(&mut record).map_err(|error| {
                IngestError::row(
                    file,
                    error.position().map_or(0, csv::Position::line),
                    error.to_string(),
                    "correct the line",
                )
            })?;
            if !more {
                break;
            }
            let position = record.position().map_or((0, 0), |place| (place.line(), place.byte()));
            if position.1 > reported + (1 << 20) {
                parsed(position.1 - reported);
                reported = position.1;
            }
            let Some((time, row)) = parse_row(file, position.0, &record, columns)? else {
                table.dropped += 1;
                if !table.rows.is_empty() {
                    table.first_inner_nan.get_or_insert(position.0);
                }
                continue;
            };
            if table.times.last().is_some_and(|&last| time <= last) {
                table.dropped += 1;
                reversed += 1;
                table.first_reversal.get_or_insert(position.0);
                continue;
            }
            table.times.push(time);
            table.rows.push(row);
        }
        parsed((bytes.len() as u64).saturating_sub(reported));
        table.check(reversed)?;
        Ok(table)
    }

    fn check(&self, reversed: usize) -> Result<(), IngestError> {
        if self.rows.is_empty() {
            return Err(IngestError::session(
                &self.file,
                format!("the file has no usable row (skipped: {})", self.dropped),
                "download it again",
            ));
        }
        if reversed * LARGEST_REVERSED_SHARE > self.rows.len() + reversed {
            return Err(IngestError::row(
                &self.file,
                self.first_reversal.unwrap_or(0),
                format!("time does not advance here, nor in {} further rows", reversed - 1),
                "sort the file by its first column, or cut it where the clock was set back",
            ));
        }
        Ok(())
    }

    /// Intervals longer than `longest` microseconds, as (row before, row after).
    pub fn gaps(&self, longest: i64) -> impl Iterator<Item = (i64, i64)> + '_ {
        self.times
            .windows(2)
            .map(|pair| (pair[0], pair[1]))
            .filter(move |(before, after)| after - before > longest)
    }
}

/// The time and the numbers of a row; `None` if one of them is NaN.
fn parse_row(
    file: &str,
    line: u64,
    record: &csv::ByteRecord,
    columns: usize,
) -> Result<Option<(i64, Vec<f64>)>, IngestError> {
    if record.len() < columns + 1 {
        return Err(IngestError::row(
            file,
            line,
            format!("expected {} columns, found {}", columns + 1, record.len()),
            "download the file again if it is cut short, or delete the line",
        ));
    }
    let number = |column: usize| -> Result<f64, IngestError> {
        let field = String::from_utf8_lossy(&record[column]);
        field.parse::<f64>().map_err(|_| {
            IngestError::row(
                file,
                line,
                format!("column {} is \"{field}\", not a number", column + 1),
                "correct or delete the line: NCLT's files have no header and only numbers",
            )
        })
    };
    let time = number(0)?;
    let row: Vec<f64> = (1..=columns).map(number).collect::<Result<_, _>>()?;
    if let Some(column) = row.iter().position(|value| value.is_infinite()) {
        return Err(IngestError::row(
            file,
            line,
            format!("column {} is infinite", column + 2),
            "correct or delete the line",
        ));
    }
    if time.is_nan() || row.iter().any(|value| value.is_nan()) {
        return Ok(None);
    }
    // Microseconds stay exact in a double until the year 2255.
    if !(0.0..9.0e15).contains(&time) {
        return Err(IngestError::row(
            file,
            line,
            format!("the time {time} is not in microseconds since 1970"),
            "use microseconds UTC in the first column, as NCLT does",
        ));
    }
    Ok(Some((time as i64, row)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Table, IngestError> {
        Table::parse("wheels.csv", text.as_bytes(), 2, &mut |_| ())
    }

    #[test]
    fn leading_and_inner_nan_rows_are_dropped_and_counted() {
        let table = parse("1,nan,nan\n2,1,1\n3,NaN,1\n4,2,2\n").unwrap();
        assert_eq!((table.times.as_slice(), table.dropped), (&[2, 4][..], 2));
        assert_eq!(table.first_inner_nan, Some(3));
    }

    #[test]
    fn duplicate_stamps_keep_the_first_row() {
        let rows = (0..200).map(|time| format!("{time},0,0")).collect::<Vec<_>>().join("\n") + "\n";
        let table = parse(&format!("{rows}199,7,7\n200,1,1\n")).unwrap();
        assert_eq!((table.times.len(), table.dropped, table.first_reversal), (201, 1, Some(201)));
        assert_eq!(table.rows[199], [0.0, 0.0]);
    }

    #[test]
    fn a_clock_set_back_is_refused_with_its_line() {
        let error = parse("5,0,0\n6,0,0\n1,0,0\n2,0,0\n").unwrap_err().to_string();
        assert!(error.starts_with("wheels.csv, line 3: time does not advance"), "{error}");
    }

    #[test]
    fn a_cut_line_is_refused_with_its_line() {
        let error = parse("1,0,0\n2,0\n").unwrap_err().to_string();
        assert!(
            error.starts_with(
                "wheels.csv, line 2: expected 3 columns, found 2; download the file again if it is cut short"
            ),
            "{error}"
        );
    }

    #[test]
    fn words_and_infinities_are_refused_with_line_and_column() {
        let error = parse("1,0,0\n2,fast,0\n").unwrap_err().to_string();
        assert!(error.starts_with("wheels.csv, line 2: column 2 is \"fast\""), "{error}");
        let error = parse("1,0,inf\n").unwrap_err().to_string();
        assert!(error.starts_with("wheels.csv, line 1: column 3 is infinite"), "{error}");
    }

    #[test]
    fn a_file_without_usable_rows_is_refused() {
        assert!(parse("").unwrap_err().to_string().contains("no usable row"));
        assert!(parse("1,nan,0\n").unwrap_err().to_string().contains("skipped: 1"));
    }
}
