//! One surface through arrays, glam and nalgebra: without copies, and with the same bits.

use helfrich::{
    Cotangent, DualArea, GompperKroll, Points, PointsMut, Prepared, Real, Serial, Subdivision,
    Surface,
};
use helfrich_tests::laws::{Candidate, Evaluate, Law, Subject, for_each};
use helfrich_tests::meshes::{Base, Mesh, Rough, icosphere};
use std::any::type_name;

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
fn evaluate<P, T: Real>(
    prepared: &mut dyn Evaluate<T>,
    mesh: &Mesh,
    points: &[P],
    zero: P,
) -> (T, Vec<P>)
where
    P: Clone,
    [P]: PointsMut<Scalar = T>,
{
    let mut force = vec![zero; points.len()];
    let surface = Surface::new(&mesh.connectivity, points).expect("finite positions");
    prepared.add_force(surface, force.coordinates_mut());
    (prepared.energy(surface), force)
}

/// Checks that points of another kind than arrays give the same bits.
fn check<P, T: Real>(subject: &dyn Subject<T>, mesh: &Mesh, point: impl Fn([T; 3]) -> P)
where
    P: Clone,
    [P]: PointsMut<Scalar = T>,
{
    let arrays = mesh.positions_in::<T>();
    let points = Vec::from_iter(arrays.iter().map(|&x| point(x)));
    let prepared = || subject.prepared(T::one(), &mesh.connectivity);
    let zero = [T::zero(); 3];
    let (energy, force) = evaluate::<[T; 3], T>(&mut *prepared(), mesh, &arrays, zero);
    let found = evaluate::<P, T>(&mut *prepared(), mesh, &points, point(zero));
    let what = format!("{}: {}", subject.name(), type_name::<P>());
    assert_eq!(found.0, energy, "{what}");
    assert_eq!(found.1.coordinates(), force, "{what}");
    // Methods see arrays only: `Prepared` takes all kinds.
    let mut bent = Prepared::new(GompperKroll::new(T::one()), &mesh.connectivity);
    let mut direct = vec![point(zero); points.len()];
    let surface = Surface::new(&mesh.connectivity, &points[..]).expect("finite positions");
    bent.add_force(surface, &mut direct[..]);
    assert_eq!(
        direct.coordinates(),
        evaluate::<[T; 3], T>(&mut bent, mesh, &arrays, zero).1,
        "{what}"
    );
}

#[test]
fn bits_do_not_depend_on_the_kind_of_points() {
    struct SameBits(Mesh);
    impl Law for SameBits {
        fn check<C: Candidate>(&mut self, candidate: C) {
            self.check_method(&candidate, &candidate);
        }
    }
    impl SameBits {
        fn check_method(&self, single: &dyn Subject<f32>, double: &dyn Subject<f64>) {
            let mesh = &self.0;
            check(single, mesh, glam::Vec3::from);
            check(single, mesh, nalgebra::Point3::from);
            check(double, mesh, glam::DVec3::from);
            check(double, mesh, nalgebra::Point3::from);
            check(double, mesh, nalgebra::Vector3::from);
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

/// Positions that are refined, and gradients and their divergence on triangles, are points of any kind.
#[test]
fn fields_of_vectors_are_points() {
    fn check<P: Clone>(point: impl Fn([f64; 3]) -> P)
    where
        [P]: PointsMut<Scalar = f64>,
    {
        let mesh = mesh();
        let points = Vec::from_iter(mesh.positions.iter().map(|&x| point(x)));
        let fine = Subdivision::new(&mesh.connectivity, 1).expect("a size that fits");
        let [refined, arrays] = [
            fine.refine_points(&points).coordinates().to_vec(),
            fine.refine(&mesh.positions),
        ];
        assert_eq!(refined, arrays, "{}", type_name::<P>());

        let (elements, surface) = (Cotangent::new(DualArea::Mixed), mesh.surface());
        let field = Vec::from_iter(mesh.positions.iter().map(|[x, y, z]| x * y + z));
        let triangles = mesh.connectivity.triangles().len();
        let mut gradient = vec![point([0.0; 3]); triangles];
        elements.gradient(&Serial, surface, &field, &mut gradient);
        let mut arrays = vec![[0.0; 3]; triangles];
        elements.gradient(&Serial, surface, &field, &mut arrays);
        assert_eq!(gradient.coordinates(), arrays, "{}", type_name::<P>());
        let [mut found, mut expected] = [(); 2].map(|()| vec![0.0; field.len()]);
        elements.integrated_divergence(&Serial, surface, &gradient, &mut found);
        elements.integrated_divergence(&Serial, surface, &arrays, &mut expected);
        assert_eq!(found, expected, "{}", type_name::<P>());
    }
    check(glam::DVec3::from);
    check(nalgebra::Point3::from);
    check(nalgebra::Vector3::from);
}
