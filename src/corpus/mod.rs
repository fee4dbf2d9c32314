//! One question asked of many levels: rows that say what came of each, the file that a later run resumes from, JUnit for
//! continuous integration, what changed since an older run. Plain data and functions of it: who asks the question, on
//! how many threads and with what clock, is the caller's.

mod baseline;
mod formats;
mod junit;
mod record;
mod row;

pub use baseline::{Change, Comparison, Flip, Lengthened, Lone};
pub use formats::{CSV_HEADER, csv_line, summary, table};
pub use junit::junit;
pub use record::{BadRecord, Kept, Record};
pub use row::{Key, ROW_VERSION, Row, Settings, Timing};
