//! Every shader parses, keeps to what any device offers, translates to every language that wgpu
//! feeds, and lays its structs out as the host does.

use naga::back::{glsl, hlsl, msl, spv, wgsl};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{AddressSpace, ImageClass, Module, ScalarKind, ShaderStage, TypeInner};
use rapier3d_medial::batch::gpu::layout::{LAYOUTS, MAX_GROUPS};
use rapier3d_medial::batch::gpu::shaders::MODULES;

fn parsed() -> Vec<(&'static str, Module, ModuleInfo)> {
    MODULES
        .iter()
        .map(|m| {
            let source = m.source();
            let module = naga::front::wgsl::parse_str(&source)
                .unwrap_or_else(|e| panic!("{}: {}", m.name, e.emit_to_string(&source)));
            let info = Validator::new(ValidationFlags::all(), Capabilities::empty())
                .validate(&module)
                .unwrap_or_else(|e| panic!("{}: {}", m.name, e.emit_to_string(&source)));
            (m.name, module, info)
        })
        .collect()
}

/// The portable limits: 8 storage buffers a stage and 16 textures, 256 threads a group, 16 KB of its
/// memory.
#[test]
fn shaders_keep_to_what_every_device_offers() {
    for (name, module, info) in parsed() {
        let mut layouter = naga::proc::Layouter::default();
        layouter.update(module.to_ctx()).expect("layouts");
        let stages: Vec<_> = module
            .entry_points
            .iter()
            .map(|e| e.name.as_str())
            .collect();
        let listed = MODULES.iter().find(|m| m.name == name).expect("listed");
        assert!(
            stages.iter().eq(listed.stages.iter().map(|s| &s.0)),
            "{name}"
        );
        for (index, entry) in module.entry_points.iter().enumerate() {
            assert_eq!(entry.stage, ShaderStage::Compute);
            let threads: u32 = entry.workgroup_size.iter().product();
            assert!((1..=256).contains(&threads), "{name}: {threads} threads");
            let uses = info.get_entry_point(index);
            let (mut storage, mut textures, mut shared, mut used) = (0, 0, 0, Vec::new());
            for (handle, variable) in module.global_variables.iter() {
                if uses[handle].is_empty() {
                    continue;
                }
                used.extend(variable.binding.map(|b| b.binding as usize));
                match variable.space {
                    AddressSpace::Storage { .. } => storage += 1,
                    AddressSpace::Handle => {
                        let ty = &module.types[variable.ty].inner;
                        // Whole numbers of a texture that is only read need no feature and no filter.
                        let TypeInner::Image { class, .. } = ty else {
                            panic!("{name}: {ty:?}");
                        };
                        let (kind, multi) = (ScalarKind::Uint, false);
                        assert_eq!(*class, ImageClass::Sampled { kind, multi }, "{name}");
                        textures += 1;
                    }
                    AddressSpace::WorkGroup => shared += layouter[variable.ty].size,
                    AddressSpace::Uniform | AddressSpace::Private => {}
                    other => panic!("{name}: {other:?} is not portable"),
                }
            }
            let stage = &entry.name;
            used.sort_unstable();
            assert_eq!(used, listed.stages[index].1, "{name}.{stage}");
            assert!((1..=8).contains(&storage), "{name}.{stage}: {storage}");
            assert!((1..=16).contains(&textures), "{name}.{stage}: {textures}");
            assert!(shared <= 16 << 10, "{name}.{stage}: {shared} bytes");
        }
    }
    assert_eq!(MAX_GROUPS, wgpu_limit());
}

/// The portable limit of groups in one dimension.
fn wgpu_limit() -> u32 {
    (1 << 16) - 1
}

/// Browsers refuse a literal above the largest `f32`, be it by less than half a digit.
#[test]
fn constants_are_numbers_of_single_precision() {
    for module in MODULES {
        let mut found = 0;
        for line in module.source().lines() {
            let Some((name, rest)) = line
                .strip_prefix("const ")
                .and_then(|l| l.split_once(": f32 = "))
            else {
                continue;
            };
            let digits = rest.trim_end_matches("f;");
            let value: f64 = digits.parse().expect(name);
            assert_eq!(value, f64::from(value as f32), "{name}");
            found += 1;
        }
        assert!(found >= 6, "{}: {found}", module.name);
    }
}

#[test]
fn structs_lie_as_on_the_host() {
    let mut compared = 0;
    for (name, module, _) in parsed() {
        let mut layouter = naga::proc::Layouter::default();
        layouter.update(module.to_ctx()).expect("layouts");
        for (handle, ty) in module.types.iter() {
            let TypeInner::Struct { members, .. } = &ty.inner else {
                continue;
            };
            let found = ty.name.as_deref();
            let Some((host, size, fields)) = LAYOUTS.iter().find(|l| Some(l.0) == found) else {
                continue;
            };
            // Elements of an array follow each other at the size rounded up to the alignment.
            let stride = layouter[handle].to_stride() as usize;
            assert_eq!(stride, *size, "{name}: {host}");
            assert_eq!(members.len(), fields.len(), "{name}: {host}");
            for (member, (field, offset, bytes)) in members.iter().zip(*fields) {
                assert_eq!(member.name.as_deref(), Some(*field), "{name}: {host}");
                assert_eq!(member.offset as usize, *offset, "{name}: {host}.{field}");
                let inner = layouter[member.ty].size as usize;
                assert_eq!(inner, *bytes, "{name}: {host}.{field}");
                compared += 1;
            }
        }
    }
    // Each module has all structs.
    let fields: usize = LAYOUTS.iter().map(|l| l.2.len()).sum();
    assert_eq!(compared, fields * MODULES.len());
}

fn must<T, E: std::fmt::Display>(name: &str, language: &str, result: Result<T, E>) -> T {
    result.unwrap_or_else(|e| panic!("{name} in {language}: {e}"))
}

#[test]
fn shaders_translate() {
    for (name, module, info) in parsed() {
        let words = spv::write_vec(&module, &info, &spv::Options::default(), None);
        assert!(must(name, "SPIR-V", words).len() > 100);
        let text = wgsl::write_string(&module, &info, wgsl::WriterFlags::empty());
        assert!(must(name, "WGSL", text).len() > 100);
        let options = msl::Options {
            fake_missing_bindings: true,
            ..Default::default()
        };
        let text = msl::write_string(&module, &info, &options, &Default::default());
        assert!(must(name, "MSL", text).0.len() > 100);
        let mut text = String::new();
        let options = hlsl::Options::default();
        let pipeline = hlsl::PipelineOptions::default();
        let mut writer = hlsl::Writer::new(&mut text, &options, &pipeline);
        must(name, "HLSL", writer.write(&module, &info, None));
        for entry in &module.entry_points {
            let mut text = String::new();
            let options = glsl::Options {
                version: glsl::Version::new_gles(310),
                ..Default::default()
            };
            let pipeline = glsl::PipelineOptions {
                shader_stage: ShaderStage::Compute,
                entry_point: entry.name.clone(),
                multiview: None,
            };
            let policies = naga::proc::BoundsCheckPolicies::default();
            let writer =
                glsl::Writer::new(&mut text, &module, &info, &options, &pipeline, policies);
            must(name, "GLSL", writer.and_then(|mut w| w.write()));
        }
    }
}
