//! The text of `-defaults`, which scripts read: option and value at the start of each line.

use crate::table::Row;

/// One line for every option that has a value, as set now.
pub fn defaults<S>(table: &[Row<S>], settings: &mut S) -> String {
    let mut text = String::new();
    for row in table {
        if let Some(line) = row.line(settings) {
            text.push_str(&line);
            text.push('\n');
        }
    }
    text
}
