use nonsmooth::*;
fn main() {
    let name = std::env::args().nth(1).unwrap();
    let p = testset::find(&name).unwrap();
    let theta = FnObjective::new(p.dimension, |x: &Vector| {
        let (v, g) = p.evaluate(x.as_slice());
        (v, Vector::from_vec(g))
    });
    let v = |v: &[f64]| Vector::from_column_slice(v);
    let rows = Matrix::from_fn(p.rows.len(), p.dimension, |i, j| p.rows[i][j]);
    let set = Polyhedron::boxed(v(&p.lower), v(&p.upper))
        .unwrap()
        .with_rows(&rows, &v(&p.row_lower), &v(&p.row_upper))
        .unwrap();
    println!("{set:?}");
    let max = std::env::args().nth(2).map_or(2000, |t| t.parse().unwrap());
    let r = BundleTrust::new(BundleTrustConfig { max_evaluations: max, ..Default::default() })
        .unwrap()
        .constraints(set.clone())
        .observer(TablePrinter::new(std::io::stdout()))
        .minimize(&theta, v(&p.start))
        .unwrap();
    println!("{r}");
    println!("f* {}", p.optimal_value);
    println!("{:?}", r.certificate.as_ref().map(|c| c.recheck(&set)));
}
