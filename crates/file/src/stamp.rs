//! The lines that tell when a file was made: `CAPDATE=` in local time and `GMT=`, the same instant in universal time.

use jiff::tz::TimeZone;
use jiff::{Timestamp, Zoned};
use std::path::Path;
use std::time::SystemTime;

/// Where time zone rules live if `TZ` names one.
const RULES: &str = "/usr/share/zoneinfo";

/// The rules of the machine if `TZ` is not set.
const LOCAL: &str = "/etc/localtime";

/// When summer time holds if a POSIX rule names it without saying: what the C library assumes.
const SUMMER: &str = ",M3.2.0,M11.1.0";

/// The rules of local time.
#[derive(Clone, Debug)]
pub struct Zone(TimeZone);

impl Zone {
    /// Universal time.
    pub const UTC: Self = Self(TimeZone::UTC);

    /// The zone that the value of the variable `TZ` selects: the name of a file of rules (`Europe/Paris`, with or
    /// without a `:` before it, or an absolute path) or a POSIX rule (`CET-1CEST,M3.5.0,M10.5.0/3`). An unset variable
    /// means the machine's own zone. Like the C library, it falls back on universal time.
    pub fn from_variable(tz: Option<&str>) -> Self {
        let rules = match tz.map(|name| name.strip_prefix(':').unwrap_or(name)) {
            None => from_file(Path::new(LOCAL)),
            Some("") => None,
            Some(name) => from_file(&Path::new(RULES).join(name))
                .or_else(|| TimeZone::posix(name).ok())
                .or_else(|| TimeZone::posix(&format!("{name}{SUMMER}")).ok()),
        };
        Self(rules.unwrap_or(TimeZone::UTC))
    }
}

fn from_file(path: &Path) -> Option<TimeZone> {
    TimeZone::tzif("", &std::fs::read(path).ok()?).ok()
}

/// The lines `CAPDATE= …` and `GMT= …` of an instant, without newlines.
pub fn capture_lines(time: SystemTime, zone: &Zone) -> [String; 2] {
    // Out of range only for a clock set thousands of years away.
    let instant = Timestamp::try_from(time).unwrap_or(Timestamp::UNIX_EPOCH);
    [line("CAPDATE", &instant.to_zoned(zone.0.clone())), line("GMT", &instant.to_zoned(TimeZone::UTC))]
}

fn line(name: &str, t: &Zoned) -> String {
    let (y, mo, d, h, m, s) = (t.year(), t.month(), t.day(), t.hour(), t.minute(), t.second());
    format!("{name}= {y:04}:{mo:02}:{d:02} {h:02}:{m:02}:{s:02}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::{Duration, UNIX_EPOCH};

    /// 2024-02-29 23:30:05 UTC.
    fn leap_day() -> SystemTime {
        UNIX_EPOCH + Duration::from_secs(1_709_249_405)
    }

    #[test]
    fn both_times_are_written() {
        let cet = Zone::from_variable(Some("CET-1CEST,M3.5.0,M10.5.0/3"));
        assert_eq!(capture_lines(leap_day(), &cet), ["CAPDATE= 2024:03:01 00:30:05", "GMT= 2024:02:29 23:30:05"]);
        let summer_unsaid = Zone::from_variable(Some("XST-10XDT"));
        assert_eq!(capture_lines(leap_day(), &summer_unsaid)[0], "CAPDATE= 2024:03:01 09:30:05");
        let july = leap_day() + Duration::from_secs(130 * 86400);
        assert_eq!(capture_lines(july, &cet)[0], "CAPDATE= 2024:07:09 01:30:05");
    }

    #[test]
    fn unknown_zones_are_universal_time() {
        for name in ["", "No/Such", "::", "../../etc/passwd"] {
            let [local, _] = capture_lines(leap_day(), &Zone::from_variable(Some(name)));
            assert_eq!(local, "CAPDATE= 2024:02:29 23:30:05", "{name}");
        }
    }
}
