//! A design made in natural units, for the model in SI units.

use crate::design::{claim_anew, hand_over, CertificateFile, DesignFile, SetHandOverFile};
use crate::model::{Model, ModelError};
use crate::natural_units::NaturalUnits;
use crate::programs::Synthesized;

/// A design in natural units, restated in SI units with its claims made anew, and checked there.
///
/// # Errors
/// Numbers that no file may hold.
pub(crate) fn restated(
    units: NaturalUnits,
    design: Synthesized,
) -> Result<Synthesized, ModelError> {
    let mut file: DesignFile = units.design_to_si(&design.file);
    let model = Model::new(file.model.clone())?;
    let mut own = file.certificate(&model)?;
    // Where U is singular the claims stay as they are, and the check denies them.
    let _ = claim_anew(&model, &mut own);
    let large = file.large_set_certificate(&model)?;
    file.certificate = CertificateFile::split(&own).1;
    if let (Some(mut large), Some(outer)) = (large, &mut file.outer) {
        let _ = claim_anew(&large.model, &mut large.certificate);
        outer.certificate = CertificateFile::split(&large.certificate).1;
        let handed_over = hand_over((&large.model, &large.certificate), (&model, &own));
        outer.hand_over = handed_over.as_ref().map(SetHandOverFile::of);
    }
    let report = file.verify(&model)?;
    file.verdict = report.clone();
    Ok(Synthesized {
        file,
        report,
        optimality: None,
        ..design
    })
}
