//! Why a program stops: the class word of the message, the exit status that goes with it, and the text.

use std::fmt;
use std::io;

/// Who has to act.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// The user: a wrong option, a scene that can not be rendered. Status 1.
    User,
    /// The system: a file that can not be opened, a full disk. Status 2.
    System,
    /// Us. Status 3.
    Internal,
}

impl Class {
    /// The word in the message.
    pub fn word(self) -> &'static str {
        match self {
            Self::User => "fatal",
            Self::System => "system",
            Self::Internal => "internal",
        }
    }

    /// The exit status.
    pub fn status(self) -> u8 {
        match self {
            Self::User => 1,
            Self::System => 2,
            Self::Internal => 3,
        }
    }
}

/// A message after which the program ends; prints as `CLASS - TEXT`.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub struct Failure {
    /// Who has to act.
    pub class: Class,
    /// What went wrong.
    pub text: String,
    /// What may help, for a line of its own: scripts compare the first line with Radiance's.
    pub hint: Option<String>,
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} - {}", self.class.word(), self.text)
    }
}

impl Failure {
    /// An error of this class.
    pub fn new(class: Class, text: impl Into<String>) -> Self {
        Self { class, text: text.into(), hint: None }
    }

    /// An error of the user.
    pub fn user(text: impl Into<String>) -> Self {
        Self::new(Class::User, text)
    }

    /// The same with a hint.
    #[must_use]
    pub fn hint(self, hint: impl Into<String>) -> Self {
        Self { hint: Some(hint.into()), ..self }
    }

    /// An error of the system, with what the system says about it.
    pub fn system(text: impl fmt::Display, error: &io::Error) -> Self {
        Self::new(Class::System, format!("{text}: {}", ambit_file::os_text(error)))
    }

    /// An error of ours.
    pub fn internal(text: impl Into<String>) -> Self {
        Self::new(Class::Internal, text)
    }

    /// The one message for every option that is unknown or has a bad value.
    pub fn at(word: &str) -> Self {
        Self::user(format!("command line error at '{word}'"))
    }

    /// A word that is none of those that an option knows.
    pub fn choice(option: &str, word: &str, known: &[&str]) -> Self {
        let known = known.join(", ");
        Self::user(format!("command line error at '{option}': '{word}' (expected one of: {known})"))
    }

    /// An option that is understood but can not be served yet.
    pub fn unsupported(what: &str) -> Self {
        Self::user(format!("{what} not supported"))
    }
}

impl From<ambit_file::Error> for Failure {
    fn from(error: ambit_file::Error) -> Self {
        let class = match error {
            ambit_file::Error::Io { .. } | ambit_file::Error::Expand { .. } => Class::System,
            _ => Class::User,
        };
        Self::new(class, error.to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_have_the_class_words_of_radiance() {
        let gone = io::Error::from_raw_os_error(2);
        for (failure, text, status) in [
            (Failure::at("-q"), "fatal - command line error at '-q'", 1),
            (Failure::system("write error", &gone), "system - write error: No such file or directory", 2),
            (
                Failure::choice("--how", "maybe", &["on", "off"]),
                "fatal - command line error at '--how': 'maybe' (expected one of: on, off)",
                1,
            ),
            (Failure::internal("lost"), "internal - lost", 3),
        ] {
            assert_eq!(failure.to_string(), text);
            assert_eq!(failure.class.status(), status);
        }
    }
}
