//! Set points as CSV: one row per cycle, units in the header.

use std::io;

use fric_lab::excite::{Excitation, ExcitedCycle};
use fric_log::output::{CompleteFile, OutputError, OutputFile};

/// A file under construction.
///
/// A write error contains the file's path and the message of the operating system.
pub struct SetPointTable {
    writer: csv::Writer<OutputFile>,
}

/// Columns of a platform after time and phase.
const PLATFORM_COLUMNS: [&str; 13] = [
    "x_m",
    "y_m",
    "z_m",
    "qx",
    "qy",
    "qz",
    "qw",
    "vx_m_per_s",
    "vy_m_per_s",
    "vz_m_per_s",
    "ax_m_per_s2",
    "ay_m_per_s2",
    "az_m_per_s2",
];

/// Returns a cell that a spreadsheet does not interpret as a formula, which might execute anything.
fn no_formula(cell: String) -> String {
    if cell.starts_with(['=', '+', '-', '@']) { format!("'{cell}") } else { cell }
}

impl SetPointTable {
    /// Starts at the beginning of a file.
    #[must_use]
    pub fn new(file: OutputFile) -> Self {
        Self { writer: csv::Writer::from_writer(file) }
    }

    /// Writes the names of the columns, with units.
    ///
    /// # Errors
    /// Returns [`OutputError::File`] if the file cannot be written.
    pub fn write_header(&mut self, names: &[&str], excitation: &Excitation) -> Result<(), OutputError> {
        let mut header: Vec<String> = vec!["time_s".to_owned(), "phase".to_owned()];
        if excitation.work_box().is_some() {
            header.extend(PLATFORM_COLUMNS.map(ToOwned::to_owned));
        }
        let quantities = ["length_m", "speed_m_per_s", "tension_n"];
        let quantities = if excitation.tension_bounds_n().is_some() { &quantities[..] } else { &quantities[..2] };
        for name in names {
            header.extend(quantities.iter().map(|quantity| format!("{name}_{quantity}")));
        }
        self.writer.write_record(header.into_iter().map(no_formula)).map_err(|error| self.failure(error))
    }

    /// Writes one row.
    ///
    /// # Errors
    /// Returns [`OutputError::File`] if the file cannot be written.
    pub fn write(&mut self, cycle: &ExcitedCycle<'_>) -> Result<(), OutputError> {
        // Cycle times are whole nanoseconds, but the product has the rounding noise of binary fractions.
        let time_s = (cycle.time_s * 1e9).round() / 1e9;
        self.field(&time_s.to_string())?;
        self.field(cycle.phase.name())?;
        if let Some(set_point) = &cycle.platform {
            let vectors = [&set_point.position_m, &set_point.velocity_m_per_s, &set_point.acceleration_m_per_s2];
            let [place, velocity, acceleration] = vectors.map(|vector| vector.iter().copied());
            let orientation = set_point.orientation.coords.iter().copied();
            for number in place.chain(orientation).chain(velocity).chain(acceleration) {
                self.number(number)?;
            }
        }
        for (index, cable) in cycle.cables.iter().enumerate() {
            self.number(cable.length_m)?;
            self.number(cable.speed_m_per_s)?;
            if let Some(tension_n) = cycle.tensions_n.and_then(|tensions_n| tensions_n.get(index)) {
                self.number(*tension_n)?;
            }
        }
        // An empty record ends the row.
        self.writer.write_record(None::<&[u8]>).map_err(|error| self.failure(error))
    }

    /// Returns the file with all its rows, ready to be put in its place.
    ///
    /// # Errors
    /// Returns [`OutputError::File`] if the file cannot be written.
    pub fn complete(self) -> Result<CompleteFile, OutputError> {
        let path = self.writer.get_ref().path().to_owned();
        let file = self.writer.into_inner().map_err(|error| OutputError::File { path, source: error.into_error() })?;
        file.complete()
    }

    /// Writes all digits, so that the reader gets the exact number; no negative zero.
    fn number(&mut self, number: f64) -> Result<(), OutputError> {
        self.field(&(number + 0.0).to_string())
    }

    fn field(&mut self, text: &str) -> Result<(), OutputError> {
        self.writer.write_field(text).map_err(|error| self.failure(error))
    }

    fn failure(&self, error: csv::Error) -> OutputError {
        let source = match error.into_kind() {
            csv::ErrorKind::Io(error) => error,
            // Rows have the length of the header, and all cells are text.
            kind => io::Error::other(format!("{kind:?}")),
        };
        OutputError::File { path: self.writer.get_ref().path().to_owned(), source }
    }
}
