//! Serialization of medial meshes by serde (feature `serde`). Binary formats hold the bytes of a baked mesh
//! ([`super::asset`]). Text formats such as JSON list spheres, edges and faces, and trees are computed on loading.

use super::asset::{mass_numbers, mass_of};
use super::mesh::MedialMesh;
use super::sphere::MedialSphere;
use crate::math::{Real, Vector};
use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;

/// A mesh in text formats: lists of spheres, edges and faces.
#[derive(Serialize, Deserialize)]
#[serde(rename = "MedialMesh", deny_unknown_fields)]
struct TextMesh {
    /// Centre and radius.
    spheres: Vec<[Real; 4]>,
    #[serde(default)]
    edges: Vec<[u32; 2]>,
    #[serde(default)]
    faces: Vec<[u32; 3]>,
    /// Mass properties measured on the source, at unit density: centre, 1/mass, 1/principal inertia,
    /// its frame (x y z w).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    source_mass: Option<[Real; 11]>,
    /// Whether each connected part is convex.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    of_convex_pieces: bool,
}

impl Serialize for MedialMesh {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if !serializer.is_human_readable() {
            return serializer.serialize_bytes(&self.to_bytes());
        }
        let numbers = |s: &MedialSphere| [s.center.x, s.center.y, s.center.z, s.radius];
        TextMesh {
            spheres: self.spheres().iter().map(numbers).collect(),
            edges: self.edges().to_vec(),
            faces: self.faces().to_vec(),
            source_mass: self.parts().source_mass.as_ref().map(mass_numbers),
            of_convex_pieces: self.parts().is_of_convex_pieces,
        }
        .serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for MedialMesh {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        if !deserializer.is_human_readable() {
            return deserializer.deserialize_bytes(Baked);
        }
        let listed = TextMesh::deserialize(deserializer)?;
        let sphere = |&[x, y, z, r]: &[Real; 4]| MedialSphere::new(Vector::new(x, y, z), r);
        let spheres = listed.spheres.iter().map(sphere).collect();
        let mesh = Self::new(spheres, listed.edges, listed.faces).map_err(D::Error::custom)?;
        let mesh = mesh.of_convex_pieces(listed.of_convex_pieces);
        Ok(match listed.source_mass {
            Some(numbers) => {
                mesh.with_mass_properties(mass_of(1, &numbers).map_err(D::Error::custom)?)
            }
            None => mesh,
        })
    }
}

struct Baked;

impl<'de> Visitor<'de> for Baked {
    type Value = MedialMesh;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("the bytes of a baked medial mesh")
    }

    fn visit_bytes<E: Error>(self, bytes: &[u8]) -> Result<MedialMesh, E> {
        MedialMesh::from_bytes(bytes).map_err(E::custom)
    }

    /// Formats without a type for bytes write a list of them. It grows as they come: a length that is
    /// only claimed allocates nothing.
    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<MedialMesh, A::Error> {
        let mut bytes = Vec::new();
        while let Some(byte) = list.next_element()? {
            bytes.push(byte);
        }
        self.visit_bytes(&bytes)
    }
}
