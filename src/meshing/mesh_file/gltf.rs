//! glTF 2.0, as JSON with buffers beside it or as one binary file (GLB), by the crate `gltf`: all triangles
//! of the scene, each mesh moved by its nodes. Skins and morph targets are left at rest, animations,
//! points and lines left out.

use super::{Polygons, Source};
use crate::error::BuildError;
use crate::math::{Real, Vector};
use gltf::accessor::{DataType, Dimensions};
use gltf::buffer::Source as BufferSource;
use gltf::json::Root;
use gltf::mesh::Mode;
use gltf::{Accessor, Document, Node, Primitive, Semantic};
use nalgebra::{Matrix4, Point3};
use std::io::ErrorKind;

/// Largest number of vertices, and of triangles, of a scene. The size of the file is no bound, since one mesh may hang
/// on many nodes.
const MAX_ELEMENTS: usize = 100_000_000;

/// Reads the scene that the file opens with, or all of it where it names none.
pub fn read(source: &Source) -> Result<Polygons, BuildError> {
    let refused = |error: gltf::Error| in_file(source, error.to_string());
    let (json, blob) = match source.bytes.starts_with(b"glTF") {
        true => chunks(source)?,
        false => (source.bytes, None),
    };
    let root = Root::from_slice(json).map_err(|error| in_file(source, error.to_string()))?;
    let mut primitives = root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    // The crate's own check of a mesh looks at accessors that are not there.
    let lost = primitives.find_map(|primitive| {
        let mut used = primitive.attributes.values().map(|index| index.value());
        used.find(|index| *index >= root.accessors.len())
    });
    if let Some(lost) = lost {
        return Err(in_file(source, format!("accessor {lost} is not there")));
    }
    let document = Document::from_json(root).map_err(refused)?;
    let buffers = gltf::import_buffers(&document, source.name.parent(), blob);
    let buffers = buffers.map_err(|error| match (&error, lost_buffer(source, &document)) {
        (gltf::Error::Io(io), Some(name)) if io.kind() == ErrorKind::NotFound => {
            in_file(source, format!("the buffer {name:?} is not there"))
        }
        _ => refused(error),
    })?;
    let mut polygons = Polygons::default();
    let mut seen = vec![false; document.nodes().len()];
    let mut left: Vec<(Node, Matrix4<f64>)> = roots(&document)
        .map(|node| (node, Matrix4::identity()))
        .collect();
    while let Some((node, parent)) = left.pop() {
        if std::mem::replace(&mut seen[node.index()], true) {
            let message = format!("node {} hangs on two nodes, or on itself", node.index());
            return Err(in_file(source, message));
        }
        let columns = node.transform().matrix();
        let own = Matrix4::from_fn(|row, column| f64::from(columns[column][row]));
        let place = parent * own;
        for primitive in node.mesh().iter().flat_map(|mesh| mesh.primitives()) {
            add(&mut polygons, &primitive, &place, &buffers)
                .map_err(|message| in_file(source, format!("node {}: {message}", node.index())))?;
        }
        left.extend(node.children().map(|child| (child, place)));
    }
    Ok(polygons)
}

/// The two chunks of a binary file: JSON, and the buffer where there is one. The crate's own reader
/// overflows on lengths that lie.
fn chunks<'a>(source: &Source<'a>) -> Result<(&'a [u8], Option<Vec<u8>>), BuildError> {
    /// Magic number, version, length of the file.
    const HEADER: usize = 12;
    let chunk = |at: usize, name: &[u8; 4]| {
        let head = source.bytes.get(at..at + 8)?;
        let length = u32::from_le_bytes([head[0], head[1], head[2], head[3]]) as usize;
        let content = source.bytes.get(at + 8..)?.get(..length)?;
        (head[4..] == *name).then_some(content)
    };
    let json = chunk(HEADER, b"JSON");
    let json = json.ok_or_else(|| source.at_byte(HEADER, "no whole chunk of JSON"))?;
    let next = HEADER + 8 + json.len();
    let blob = match next < source.bytes.len() {
        true => {
            let chunk = chunk(next, b"BIN\0");
            Some(chunk.ok_or_else(|| source.at_byte(next, "no whole chunk of a buffer"))?)
        }
        false => None,
    };
    Ok((json, blob.map(<[u8]>::to_vec)))
}

/// The name of the first buffer in a file of its own that does not exist.
fn lost_buffer(source: &Source, document: &Document) -> Option<String> {
    let mut buffers = document.buffers();
    buffers.find_map(|buffer| match buffer.source() {
        BufferSource::Uri(uri) if !uri.starts_with("data:") => {
            let folder = source.name.parent()?;
            (!folder.join(uri).exists()).then(|| uri.into())
        }
        _ => None,
    })
}

/// The nodes that hang on no other, of one scene.
fn roots(document: &Document) -> Box<dyn Iterator<Item = Node<'_>> + '_> {
    match document.default_scene().or(document.scenes().next()) {
        Some(scene) => Box::new(scene.nodes()),
        None => {
            let mut hangs = vec![false; document.nodes().len()];
            let children = document.nodes().flat_map(|node| node.children());
            children.for_each(|child| hangs[child.index()] = true);
            Box::new(document.nodes().filter(move |node| !hangs[node.index()]))
        }
    }
}

/// Adds the triangles of a primitive, moved by `place`.
fn add(
    polygons: &mut Polygons,
    primitive: &Primitive,
    place: &Matrix4<f64>,
    buffers: &[gltf::buffer::Data],
) -> Result<(), String> {
    let mode = primitive.mode();
    if !matches!(
        mode,
        Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan
    ) {
        return Ok(());
    }
    let most = buffers.iter().map(|data| data.0.len()).sum();
    let Some(accessor) = primitive.get(&Semantic::Positions) else {
        return Err("a mesh has no positions".into());
    };
    check(&accessor, (DataType::F32, Dimensions::Vec3), most)?;
    if let Some(indices) = primitive.indices() {
        let kinds = [DataType::U8, DataType::U16, DataType::U32];
        let kind = kinds.iter().find(|kind| **kind == indices.data_type());
        let kind = *kind.unwrap_or(&DataType::U32);
        check(&indices, (kind, Dimensions::Scalar), most)?;
    }
    let reader = primitive.reader(|buffer| buffers.get(buffer.index()).map(|data| &data.0[..]));
    let positions = reader.read_positions();
    let positions = positions.ok_or("the positions of a mesh cannot be read")?;
    let first = polygons.vertices.len();
    polygons.vertices.extend(positions.map(|position| {
        let moved = place.transform_point(&Point3::from(position.map(f64::from)));
        Vector::new(moved.x as Real, moved.y as Real, moved.z as Real)
    }));
    let count = polygons.vertices.len() - first;
    let corners: Vec<u64> = match (primitive.indices(), reader.read_indices()) {
        (None, _) => (0..count as u64).collect(),
        (_, Some(indices)) => indices.into_u32().map(u64::from).collect(),
        _ => return Err("the indices of a mesh cannot be read".into()),
    };
    if let Some(beyond) = corners.iter().find(|corner| **corner >= count as u64) {
        return Err(format!(
            "a triangle's vertex {beyond} (from 0) is not among the {count}"
        ));
    }
    if first + count > MAX_ELEMENTS || polygons.corners.len() + 3 * corners.len() > 3 * MAX_ELEMENTS
    {
        return Err(format!(
            "the scene has more than {MAX_ELEMENTS} vertices or triangles"
        ));
    }
    // A mirrored node turns its triangles inside out.
    let mirrored = place.fixed_view::<3, 3>(0, 0).determinant() < 0.0;
    for [a, b, c] in triangles(mode, &corners)? {
        let corners = if mirrored { [a, c, b] } else { [a, b, c] };
        let moved = corners.map(|corner| first as u64 + corner);
        polygons.corners.extend(moved);
        polygons.close_polygon(None);
    }
    Ok(())
}

/// The triangles that corners make, all facing one way.
fn triangles(mode: Mode, corners: &[u64]) -> Result<Vec<[u64; 3]>, String> {
    let triple = |t: &[u64]| [t[0], t[1], t[2]];
    match mode {
        Mode::TriangleStrip => {
            let strip = corners.windows(3).enumerate();
            let turned = strip.map(|(k, t)| match k % 2 {
                0 => triple(t),
                _ => [t[0], t[2], t[1]],
            });
            Ok(turned.collect())
        }
        Mode::TriangleFan => {
            let fan = corners.windows(2).skip(1);
            Ok(fan.map(|t| [corners[0], t[0], t[1]]).collect())
        }
        _ if !corners.len().is_multiple_of(3) => Err(format!(
            "{} corners are not those of whole triangles",
            corners.len()
        )),
        _ => Ok(corners.chunks_exact(3).map(triple).collect()),
    }
}

/// Refuses what the crate's reader takes on trust: its type, and a count that no buffer could fill.
fn check(
    accessor: &Accessor,
    (data_type, dimensions): (DataType, Dimensions),
    most: usize,
) -> Result<(), String> {
    let number = accessor.index();
    if (accessor.data_type(), accessor.dimensions()) != (data_type, dimensions) {
        let [is, must] = [accessor.data_type(), data_type].map(|t| format!("{t:?}"));
        return Err(format!(
            "accessor {number} holds {:?} of {is}, must {dimensions:?} of {must}",
            accessor.dimensions()
        ));
    }
    match accessor.count() {
        0 => Err(format!("accessor {number} holds nothing")),
        count if count > most => Err(format!(
            "accessor {number} counts {count} elements, the buffers have {most} bytes"
        )),
        _ => Ok(()),
    }
}

fn in_file(source: &Source, message: String) -> BuildError {
    BuildError::Syntax {
        path: source.path(),
        location: "glTF".into(),
        message,
    }
}
