//! Options for colours, and arguments of `completions` and `man`.

use clap::{Args, ColorChoice, ValueEnum};
use clap_complete::Shell;

/// When texts have colours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum ColorMode {
    /// On a terminal, unless the environment sets NO_COLOR.
    #[default]
    Auto,
    /// Also in files and pipes.
    Always,
    /// Nowhere.
    Never,
}

impl ColorMode {
    /// Finds the mode in a command line that is not parsed yet. The parser needs it for its own messages; it reports wrong values itself.
    pub fn find<'a>(args: impl IntoIterator<Item = &'a str>) -> Self {
        let mut args = args.into_iter().take_while(|arg| *arg != "--");
        let mut found = Self::default();
        while let Some(arg) = args.next() {
            let value = if arg == "--color" { args.next() } else { arg.strip_prefix("--color=") };
            found = value.and_then(|value| Self::from_str(value, false).ok()).unwrap_or(found);
        }
        found
    }

    /// Decides for standard output.
    pub fn applies(self, is_terminal: bool, no_color: bool) -> bool {
        match self {
            Self::Auto => is_terminal && !no_color,
            Self::Always => true,
            Self::Never => false,
        }
    }
}

impl From<ColorMode> for ColorChoice {
    fn from(mode: ColorMode) -> Self {
        match mode {
            ColorMode::Auto => Self::Auto,
            ColorMode::Always => Self::Always,
            ColorMode::Never => Self::Never,
        }
    }
}

/// Arguments of `completions`.
#[derive(Clone, Debug, Args)]
pub struct CompletionsArgs {
    /// The shell.
    #[arg(value_enum)]
    pub shell: Shell,
}

/// Arguments of `man`.
#[derive(Clone, Debug, Args)]
pub struct ManArgs {
    /// The command [default: the program].
    pub command: Option<String>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mode_is_found_before_parsing() {
        for (args, mode) in [
            ("run a", ColorMode::Auto),
            ("run a --color never", ColorMode::Never),
            ("--color=always run a", ColorMode::Always),
            ("run --color=often", ColorMode::Auto),
            ("run -- --color=never", ColorMode::Auto),
            ("run --color", ColorMode::Auto),
        ] {
            assert_eq!(ColorMode::find(args.split(' ')), mode, "{args}");
        }
    }

    #[test]
    fn only_auto_asks_terminal_and_environment() {
        let all = [(false, false), (false, true), (true, false), (true, true)];
        let of = |mode: ColorMode| all.map(|(is_terminal, no_color)| mode.applies(is_terminal, no_color));
        assert_eq!(of(ColorMode::Auto), [false, false, true, false]);
        assert_eq!(of(ColorMode::Always), [true; 4]);
        assert_eq!(of(ColorMode::Never), [false; 4]);
    }
}
