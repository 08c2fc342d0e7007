//! Objectives and constraints, as text.

use std::fmt;
use std::str::FromStr;

/// Direction in which values are better.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ObjectiveDirection {
    /// The smaller.
    Min,
    /// The larger.
    Max,
}

/// A column that is to be as small or as large as possible: `cycles min`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Objective {
    /// Name of the column.
    pub column: String,
    /// Direction in which values are better.
    pub goal: ObjectiveDirection,
}

/// Constraint on a point: `quality.psnr_db >= 36`.
#[derive(Clone, Debug, PartialEq)]
pub struct Constraint {
    /// Name of the column.
    pub column: String,
    /// Required relation of the value to the bound.
    pub comparison: ConstraintRelation,
    /// The bound, in the unit of the column; finite.
    pub bound: f64,
}

/// Relation of a value to a bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConstraintRelation {
    /// `>=`
    AtLeast,
    /// `<=`
    AtMost,
    /// `>`
    Above,
    /// `<`
    Below,
    /// `=`, also written `==`
    Equal,
}

/// Error in the text of an objective or a constraint.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RuleError {
    /// No column and goal.
    #[error("objective `{0}`: expected the name of a figure and `min` or `max`, as in `cycles min`")]
    Objective(String),
    /// No column, comparison and bound.
    #[error(
        "constraint `{0}`: expected the name of a figure, one of `>=`, `<=`, `>`, `<`, `=`, and a number, \
         as in `quality.psnr_db >= 36`"
    )]
    Constraint(String),
}

impl ObjectiveDirection {
    /// Returns true if `a` is better than `b`.
    pub fn better(self, a: f64, b: f64) -> bool {
        match self {
            Self::Min => a < b,
            Self::Max => a > b,
        }
    }

    /// A value of which the smaller is better.
    pub fn cost(self, value: f64) -> f64 {
        match self {
            Self::Min => value,
            Self::Max => -value,
        }
    }
}

impl fmt::Display for ObjectiveDirection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Min => "min",
            Self::Max => "max",
        })
    }
}

impl ConstraintRelation {
    /// All, two characters before one, so that the first that is found in a text is the right one.
    const ALL: [(&'static str, Self); 6] = [
        (">=", Self::AtLeast),
        ("<=", Self::AtMost),
        ("==", Self::Equal),
        (">", Self::Above),
        ("<", Self::Below),
        ("=", Self::Equal),
    ];
}

impl fmt::Display for ConstraintRelation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::AtLeast => ">=",
            Self::AtMost => "<=",
            Self::Above => ">",
            Self::Below => "<",
            Self::Equal => "=",
        })
    }
}

impl Constraint {
    /// Returns true if a value meets the constraint.
    pub fn keeps(&self, value: f64) -> bool {
        match self.comparison {
            ConstraintRelation::AtLeast => value >= self.bound,
            ConstraintRelation::AtMost => value <= self.bound,
            ConstraintRelation::Above => value > self.bound,
            ConstraintRelation::Below => value < self.bound,
            ConstraintRelation::Equal => value == self.bound,
        }
    }
}

impl fmt::Display for Objective {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.column, self.goal)
    }
}

impl fmt::Display for Constraint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} {}", self.column, self.comparison, self.bound)
    }
}

/// Parses the form `cycles min`.
impl FromStr for Objective {
    type Err = RuleError;

    fn from_str(text: &str) -> Result<Self, RuleError> {
        let wrong = || RuleError::Objective(text.into());
        let mut words = text.split_whitespace();
        let (Some(column), Some(goal), None) = (words.next(), words.next(), words.next()) else { return Err(wrong()) };
        let goal = match goal {
            "min" => ObjectiveDirection::Min,
            "max" => ObjectiveDirection::Max,
            _ => return Err(wrong()),
        };
        Ok(Self { column: column.into(), goal })
    }
}

/// Parses the form `quality.psnr_db >= 36`, with or without blanks.
impl FromStr for Constraint {
    type Err = RuleError;

    fn from_str(text: &str) -> Result<Self, RuleError> {
        let wrong = || RuleError::Constraint(text.into());
        let at = text.find(['<', '>', '=']).ok_or_else(wrong)?;
        let (column, rest) = (text[..at].trim(), &text[at..]);
        let found = ConstraintRelation::ALL.iter().find_map(|(sign, comparison)| Some((*comparison, rest.strip_prefix(sign)?)));
        let (comparison, bound) = found.ok_or_else(wrong)?;
        let bound: f64 = bound.trim().parse().map_err(|_| wrong())?;
        if column.is_empty() || column.contains(char::is_whitespace) || !bound.is_finite() {
            return Err(wrong());
        }
        Ok(Self { column: column.into(), comparison, bound })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn objectives_and_constraints_read_back_as_they_are_written() {
        for text in ["cycles min", "quality.psnr_db max"] {
            assert_eq!(text.parse::<Objective>().unwrap().to_string(), text);
        }
        for text in ["quality.psnr_db >= 36", "a <= 0.5", "a > -1", "a < 1", "a = 2"] {
            assert_eq!(text.parse::<Constraint>().unwrap().to_string(), text);
        }
        let tight: Constraint = "a==1e3".parse().unwrap();
        assert_eq!(tight, Constraint { column: "a".into(), comparison: ConstraintRelation::Equal, bound: 1000.0 });
    }

    #[test]
    fn wrong_rules_say_what_was_expected() {
        for text in ["", "cycles", "cycles least", "min cycles", "cycles min max"] {
            let error = text.parse::<Objective>().unwrap_err().to_string();
            assert!(error.contains(&format!("`{text}`")) && error.contains("`min` or `max`"), "{error}");
        }
        for text in ["", "a", "a >=", ">= 3", "a => 3", "a >= x", "a >= inf", "a >= NaN", "a b > 1", "a >> 1"] {
            let error = text.parse::<Constraint>().unwrap_err().to_string();
            assert!(error.contains(&format!("`{text}`")) && error.contains("and a number"), "{error}");
        }
    }

    #[test]
    fn bounds_are_kept_to_the_letter() {
        let kept = |text: &str| [0.0, 1.0, 2.0].map(|x| text.parse::<Constraint>().unwrap().keeps(x));
        assert_eq!(kept("a >= 1"), [false, true, true]);
        assert_eq!(kept("a <= 1"), [true, true, false]);
        assert_eq!(kept("a > 1"), [false, false, true]);
        assert_eq!(kept("a < 1"), [true, false, false]);
        assert_eq!(kept("a = 1"), [false, true, false]);
    }
}
