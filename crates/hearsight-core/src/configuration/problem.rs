//! The one error of the configuration: file, field, value, cure, and the place in the text.

use miette::{Diagnostic, NamedSource, SourceSpan};

/// What is wrong with a configuration file, where, and what helps.
#[derive(Clone, Debug, thiserror::Error, Diagnostic)]
#[error(transparent)]
#[diagnostic(transparent)]
pub struct ConfigurationError(Box<Problem>);

/// The content of a [`ConfigurationError`], which is one pointer wide.
#[derive(Clone, Debug, thiserror::Error, Diagnostic)]
#[error("{message}")]
#[diagnostic(code(hearsight::configuration))]
pub struct Problem {
    /// File, field and value, and what is wrong with them, in one sentence.
    pub message: String,
    /// The text of the file.
    #[source_code]
    pub text: NamedSource<String>,
    /// Where in the text, in bytes.
    #[label("here")]
    pub span: Option<SourceSpan>,
    /// What helps.
    #[help]
    pub cure: Option<String>,
}

impl From<Problem> for ConfigurationError {
    fn from(problem: Problem) -> Self {
        Self(Box::new(problem))
    }
}

impl std::ops::Deref for ConfigurationError {
    type Target = Problem;

    fn deref(&self) -> &Problem {
        &self.0
    }
}

impl Problem {
    /// Line and column of the place, both from 1, where it is known.
    pub fn line_and_column(&self) -> Option<(usize, usize)> {
        let offset = self.span?.offset();
        let before = self.text.inner().get(..offset)?;
        let line = before.matches('\n').count() + 1;
        let column = before.chars().rev().take_while(|&c| c != '\n').count() + 1;
        Some((line, column))
    }
}
