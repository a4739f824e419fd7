//! Why a campaign has no page.

use crate::batch::campaign::CampaignError;
use crate::report::chart::FigureError;

/// Why a campaign's page cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum CampaignPageError {
    /// Its files.
    #[error(transparent)]
    Campaign(#[from] CampaignError),
    /// The campaign is still running.
    #[error(
        "the campaign is not complete; the same `campaign` command goes on where it stopped, and then \
         there is a report"
    )]
    Running,
    /// A figure.
    #[error("the report's figures cannot be drawn: {0}")]
    Figure(#[from] FigureError),
}
