//! Text files of measured spectra: wavelengths in the first column, values in others.

/// A row: the number of its line, from 1, and (wavelength in nm, value).
type Row = (usize, [f64; 2]);

/// The rows of a column of a text file, counted from 1; columns stand apart by commas, semicolons, tabs or blanks. Lines
/// that are empty or begin with # are passed over, and so is a first line of titles.
///
/// # Errors
/// The line and what is wrong with it.
pub(super) fn read_columns(text: &str, column: usize) -> Result<Vec<Row>, (usize, String)> {
    let (mut rows, mut titles) = (Vec::new(), true);
    for (number, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let cells = cells(line);
        let numbers: Result<Vec<f64>, &str> = [0, column - 1]
            .into_iter()
            .map(|at| {
                let cell = cells.get(at).copied().unwrap_or("");
                cell.parse().map_err(|_| cell)
            })
            .collect();
        match numbers {
            Ok(pair) => rows.push((number + 1, [pair[0], pair[1]])),
            Err(_) if titles && cells[0].parse::<f64>().is_err() => {}
            Err("") => return Err((number + 1, format!("there is no column {column}, only {}", cells.len()))),
            Err(cell) => return Err((number + 1, format!("{cell:?} is not a number"))),
        }
        titles = false;
    }
    if rows.is_empty() { Err((1, "there are no numbers".into())) } else { Ok(rows) }
}

/// Blanks separate cells only where nothing else does.
fn cells(line: &str) -> Vec<&str> {
    match [';', ',', '\t'].into_iter().find(|&separator| line.contains(separator)) {
        Some(separator) => line.split(separator).map(str::trim).collect(),
        None => line.split_whitespace().collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::read_columns;

    #[test]
    fn titles_comments_and_any_separator_are_understood() {
        let text = "# a paint\nnm, dull, shiny\n400, 0.1, 0.2\n\n500, 0.3, 0.4\n";
        let rows = read_columns(text, 3).unwrap();
        assert_eq!(rows, [(3, [400.0, 0.2]), (5, [500.0, 0.4])]);
        assert_eq!(read_columns("400 1e-3\n410\t2e-3", 2).unwrap()[1].1, [410.0, 2e-3]);
        assert_eq!(read_columns("400;0.5", 2).unwrap(), [(1, [400.0, 0.5])]);
    }

    #[test]
    fn a_mistake_is_told_with_its_line() {
        assert_eq!(read_columns("400, 0.1\n500, red", 2), Err((2, "\"red\" is not a number".into())));
        assert_eq!(read_columns("nm, v\n400, 0.1", 3), Err((2, "there is no column 3, only 2".into())));
        assert_eq!(read_columns("# nothing", 2), Err((1, "there are no numbers".into())));
    }
}
