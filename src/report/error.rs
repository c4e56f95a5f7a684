//! What can go wrong while a report is drawn or written.

/// A report, or one of its figures, could not be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// The font that comes with the program is damaged.
    #[error("bundled font `{name}` cannot be read")]
    Font {
        /// File name under `assets/`.
        name: &'static str,
    },
    /// The drawing library refused a figure.
    #[error("figure `{figure}`: {cause}")]
    Draw {
        /// Title of the figure.
        figure: String,
        /// What the drawing library said.
        cause: String,
    },
    /// The report page could not be put together.
    #[error("report page: {0}")]
    Page(#[from] minijinja::Error),
    /// A table could not be put into Parquet.
    #[error("Parquet: {0}")]
    Parquet(String),
    /// The moving picture could not be encoded.
    #[error("moving picture: {0}")]
    Gif(#[from] gif::EncodingError),
}
