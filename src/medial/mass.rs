//! To come.
use super::mesh::MedialMesh;
use parry3d::mass_properties::MassProperties;
/// To come.
pub fn solid_mass_properties(_mesh: &MedialMesh) -> MassProperties {
    MassProperties::default()
}
