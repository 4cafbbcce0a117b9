//! One surface through arrays, glam and nalgebra: without copies, and with the same bits.

use helfrich::Prepared;
use helfrich::{Points, PointsMut, Real, Surface};
use helfrich_tests::laws::{Candidate, Law, for_each};
use helfrich_tests::meshes::{Base, Mesh, Rough, icosphere};

fn mesh() -> Mesh {
    let rough = Rough {
        base: Base::Icosphere,
        seed: 1,
        amplitude: 0.2,
        refinement: 2,
    };
    rough.mesh()
}

/// Energy and forces, with positions and forces in one kind of points.
fn evaluate<P>(candidate: impl Candidate, mesh: &Mesh, points: &P, force: &mut P) -> P::Scalar
where
    P: PointsMut + ?Sized,
{
    let surface = Surface::new(&mesh.connectivity, points).expect("finite positions");
    let method = candidate.method(P::Scalar::constant(1.0));
    let mut prepared = Prepared::new(method, &mesh.connectivity);
    prepared.add_force(surface, force);
    prepared.energy(surface)
}

#[test]
fn bits_do_not_depend_on_the_kind_of_points() {
    struct SameBits(Mesh);
    impl Law for SameBits {
        fn check<C: Candidate>(&mut self, candidate: C) {
            let mesh = &self.0;
            let count = mesh.positions.len();
            let name = candidate.name();

            let arrays = mesh.positions_in::<f32>();
            let mut force = vec![[0.0_f32; 3]; count];
            let energy = evaluate(candidate, mesh, &arrays, &mut force);
            let glam = Vec::from_iter(arrays.iter().map(|&x| glam::Vec3::from(x)));
            let mut glam_force = vec![glam::Vec3::ZERO; count];
            let glam_energy = evaluate(candidate, mesh, &glam, &mut glam_force);
            assert_eq!(energy.to_bits(), glam_energy.to_bits(), "{name}: Vec3");
            assert_eq!(force, glam_force.coordinates(), "{name}: Vec3");
            let nalgebra = Vec::from_iter(arrays.iter().map(|&x| nalgebra::Point3::from(x)));
            let mut nalgebra_force = vec![nalgebra::Point3::origin(); count];
            evaluate(candidate, mesh, &nalgebra, &mut nalgebra_force);
            assert_eq!(force, nalgebra_force.coordinates(), "{name}: Point3<f32>");

            let arrays = &mesh.positions;
            let mut force = vec![[0.0_f64; 3]; count];
            let energy = evaluate(candidate, mesh, arrays, &mut force);
            let glam = Vec::from_iter(arrays.iter().map(|&x| glam::DVec3::from(x)));
            let mut glam_force = vec![glam::DVec3::ZERO; count];
            let glam_energy = evaluate(candidate, mesh, &glam, &mut glam_force);
            assert_eq!(energy.to_bits(), glam_energy.to_bits(), "{name}: DVec3");
            assert_eq!(force, glam_force.coordinates(), "{name}: DVec3");
            let points = Vec::from_iter(arrays.iter().map(|&x| nalgebra::Point3::from(x)));
            let mut points_force = vec![nalgebra::Point3::origin(); count];
            let points_energy = evaluate(candidate, mesh, &points, &mut points_force);
            assert_eq!(energy.to_bits(), points_energy.to_bits(), "{name}: Point3");
            assert_eq!(force, points_force.coordinates(), "{name}: Point3");
            let vectors = Vec::from_iter(arrays.iter().map(|&x| nalgebra::Vector3::from(x)));
            let mut vectors_force = vec![nalgebra::Vector3::zeros(); count];
            let vectors_energy = evaluate(candidate, mesh, &vectors, &mut vectors_force);
            assert_eq!(
                energy.to_bits(),
                vectors_energy.to_bits(),
                "{name}: Vector3"
            );
            assert_eq!(force, vectors_force.coordinates(), "{name}: Vector3");
        }
    }
    for_each(&mut SameBits(mesh()));
}

/// Checks that a view refers to the same memory.
fn assert_view<P, T: Real>(mut points: Vec<P>)
where
    [P]: PointsMut<Scalar = T>,
{
    let (start, count) = (points.as_ptr().cast::<[T; 3]>(), points.len());
    assert_eq!(size_of::<P>(), size_of::<[T; 3]>());
    assert_eq!(
        (points.coordinates().as_ptr(), points.coordinates().len()),
        (start, count)
    );
    assert_eq!(points.as_slice().coordinates().as_ptr(), start);
    assert_eq!(points.coordinates_mut().as_ptr(), start);
    assert_eq!(points.as_mut_slice().coordinates_mut().len(), count);
}

#[test]
fn views_are_no_copies() {
    let mesh = icosphere(1);
    assert_view(mesh.positions.clone());
    assert_view(mesh.positions_in::<f32>());
    let single = || mesh.positions_in::<f32>().into_iter();
    assert_view(Vec::from_iter(single().map(glam::Vec3::from)));
    assert_view(Vec::from_iter(single().map(nalgebra::Point3::from)));
    assert_view(Vec::from_iter(single().map(nalgebra::Vector3::from)));
    let double = || mesh.positions.iter().copied();
    assert_view(Vec::from_iter(double().map(glam::DVec3::from)));
    assert_view(Vec::from_iter(double().map(nalgebra::Point3::from)));
    assert_view(Vec::from_iter(double().map(nalgebra::Vector3::from)));
    let points = double().map(nalgebra::Point3::from);
    let points = Vec::from_iter(points);
    let surface = Surface::new(&mesh.connectivity, &points).expect("finite positions");
    assert_eq!(surface.positions().as_ptr(), points.as_ptr().cast());
    let fixed = [glam::Vec3::X, glam::Vec3::Y];
    assert_eq!(fixed.coordinates(), [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
}
