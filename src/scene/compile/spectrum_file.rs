//! Text files of measured spectra: wavelengths in the first column, values in others.

/// A row of a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Row {
    /// Its line number, counted from 1.
    pub(super) line: usize,
    /// (wavelength in nm, value).
    pub(super) pair: [f64; 2],
}

/// What is wrong with a table.
#[derive(Debug, PartialEq)]
pub(super) struct TableFault {
    /// The part of the message that follows the name of the file.
    pub(super) message: String,
    pub(super) help: Option<String>,
    /// Whether the requested column does not exist.
    pub(super) is_column: bool,
}

/// Reads the rows of a column, counted from 1, of a text file. Columns are separated by commas, semicolons, tabs or
/// spaces. Lines that are empty or begin with # are skipped, and so is a first line of titles.
///
/// # Errors
/// The line and what is wrong with it.
pub(super) fn read_columns(text: &str, column: usize) -> Result<Vec<Row>, TableFault> {
    let (mut rows, mut may_be_titles) = (Vec::new(), true);
    // A single carriage return ends a line as well.
    let lines = text.trim_start_matches('\u{feff}').lines().flat_map(|line| line.split('\r'));
    for (number, line) in lines.enumerate() {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let cells = cells(line);
        let number_in = |at: usize| cells.get(at).map(|cell| cell.parse::<f64>().map_err(|_| *cell));
        match (number_in(0), number_in(column - 1)) {
            (Some(Err(_)), _) if may_be_titles => {}
            (Some(Ok(nm)), Some(Ok(value))) => rows.push(Row { line: number + 1, pair: [nm, value] }),
            (Some(Err(cell)), _) | (_, Some(Err(cell))) => return Err(not_a_number(number + 1, cell, rows.is_empty())),
            _ => {
                let message = format!(", line {}: there is no column {column}, only {}", number + 1, cells.len());
                return Err(TableFault { message, help: None, is_column: true });
            }
        }
        may_be_titles = false;
    }
    match rows.is_empty() {
        true => Err(TableFault { message: " holds no numbers".into(), help: None, is_column: false }),
        false => Ok(rows),
    }
}

fn not_a_number(line: usize, cell: &str, first: bool) -> TableFault {
    let message = match cell {
        "" => format!(", line {line}: a number is missing"),
        _ => format!(", line {line}: {cell:?} is not a number"),
    };
    let decimal = cell.split_once(',').is_some_and(|(whole, rest)| format!("{whole}.{rest}").parse::<f64>().is_ok());
    let help = match decimal {
        true => Some("use `.` as the decimal point"),
        false if first => Some("one header line may come first; lines that begin with # are ignored"),
        false => None,
    };
    TableFault { message, help: help.map(str::to_owned), is_column: false }
}

/// Splits a line into cells. Spaces separate cells only where nothing else does. In a line of several words, a comma
/// inside a word belongs to a number.
fn cells(line: &str) -> Vec<&str> {
    let has_cells = |word: &str| word.starts_with(',') || word.ends_with(',');
    let is_decimal = line.split_whitespace().nth(1).is_some() && !line.split_whitespace().any(has_cells);
    let separates = |separator: &char| line.contains(*separator) && !(*separator == ',' && is_decimal);
    match [';', ',', '\t'].into_iter().find(separates) {
        Some(separator) => line.split(separator).map(|cell| unquoted(cell.trim())).collect(),
        None => line.split_whitespace().collect(),
    }
}

/// Removes the quotes around a cell: RFC 4180, section 2. Half of a quoted cell that contains a separator keeps its
/// quote.
fn unquoted(cell: &str) -> &str {
    cell.strip_prefix('"').and_then(|cell| cell.strip_suffix('"')).map_or(cell, str::trim)
}

#[cfg(test)]
mod tests {
    use super::{Row, read_columns};

    #[test]
    fn titles_comments_and_any_separator_are_understood() {
        let text = "# a paint\nnm, dull, shiny\n400, 0.1, 0.2\n\n500, 0.3, 0.4\n";
        let rows = read_columns(text, 3).unwrap();
        let row = |line, pair| Row { line, pair };
        assert_eq!(rows, [row(3, [400.0, 0.2]), row(5, [500.0, 0.4])]);
        assert_eq!(read_columns("400 1e-3\n410\t2e-3", 2).unwrap()[1].pair, [410.0, 2e-3]);
        for ends in ["nm,v\r400,0.1\r500,0.3\r", "nm,v\r\n400,0.1\r\n500,0.3", "nm,v\n400,0.1\n500,0.3\n"] {
            assert_eq!(read_columns(ends, 2).unwrap(), [row(2, [400.0, 0.1]), row(3, [500.0, 0.3])]);
        }
        assert_eq!(read_columns("400;0.5", 2).unwrap(), [row(1, [400.0, 0.5])]);
        assert_eq!(read_columns("400 ,0.5", 2).unwrap(), [row(1, [400.0, 0.5])]);
        assert_eq!(read_columns("dull paint,shiny\n400,0.5", 2).unwrap(), [row(2, [400.0, 0.5])]);
        assert_eq!(read_columns("\"nm\",\"R, dull\"\n\"400\", \" 0.5\"", 2).unwrap(), [row(2, [400.0, 0.5])]);
    }

    #[test]
    fn a_mistake_is_reported_with_its_line() {
        let message_of = |text, column| read_columns(text, column).unwrap_err().message;
        assert_eq!(message_of("400, 0.1\n500, red", 2), ", line 2: \"red\" is not a number");
        assert_eq!(message_of("nm, v\n400, 0.1", 3), ", line 2: there is no column 3, only 2");
        for comma in ["400;0,5", "400\t0,5", "400 0,5"] {
            let fault = read_columns(comma, 2).unwrap_err();
            assert_eq!(fault.message, ", line 1: \"0,5\" is not a number");
            assert_eq!(fault.help.as_deref(), Some("use `.` as the decimal point"));
        }
        assert_eq!(message_of("\"400\",\"0,5\"", 2), ", line 1: \"\\\"0\" is not a number");
        assert_eq!(message_of("# nothing", 2), " holds no numbers");
    }
}
