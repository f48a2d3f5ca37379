!> Monitors of known fields and parcels: a linear field is measured exactly in any region inside, fluxes through a
!> plane, means of parcels by their formulas; on any number of ranks.
program test_monitors
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
  use boxes, only: boxes_t, new_boxes
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use constants, only: unset, pi
  use files, only: make_folder
  use hdf5_file, only: hdf5_file_t, start_hdf5, stop_hdf5
  use hdf5_arrays, only: get_columns
  use kinds, only: wp, i8
  use mesh, only: mesh_t, new_uniform_mesh
  use monitor_settings, only: monitor_settings_t
  use monitors, only: monitors_t
  use open_space, only: open_space_t
  use outcome, only: outcome_t
  use provenance, only: provenance_t
  use series_file, only: series_file_t
  implicit none

  ! Cells of 0.1 x 0.05 x 0.2 m; the second direction is up.
  integer, parameter :: cells(3) = [8, 12, 4]
  real(wp), parameter :: lower(3) = [1.0_wp, 0.0_wp, -0.4_wp], upper(3) = [1.8_wp, 0.6_wp, 0.4_wp]
  type(communicator_t) :: comm
  type(outcome_t) :: outcome
  type(boxes_t) :: boxes
  type(mesh_t) :: mesh
  character(len=:), allocatable :: file

  call start_ranks(comm)
  call start_hdf5()
  file = 'build/tests/monitors_'//achar(iachar('0') + comm%size)//'.h5'
  if (comm%is_root()) call make_folder('build/tests', outcome)
  mesh = new_uniform_mesh(lower, upper, cells, [.false., .false., .true.])
  call new_boxes(comm, cells, mesh%periodic, boxes, outcome)
  call measure()
  if (comm%is_root()) then
    call expect(.not. outcome%failed(), 'monitors are written')
    call test_gas()
    call test_planes()
    call test_parcels()
    call test_times()
  end if
  file = 'build/tests/monitors_open_'//achar(iachar('0') + comm%size)//'.h5'
  call measure(half_closed())
  if (comm%is_root()) then
    call test_open()
    call finish()
  end if
  call stop_hdf5()
  call stop_ranks()

contains

  function monitor(id, kind, quantity, low, high, interval) result(settings)
    character(len=*), intent(in) :: id, kind, quantity
    real(wp), intent(in) :: low(3), high(3)
    real(wp), intent(in), optional :: interval
    type(monitor_settings_t) :: settings

    settings%id = id
    settings%kind = kind
    settings%quantity = quantity
    settings%lower = low
    settings%upper = high
    if (present(interval)) settings%interval = interval
  end function monitor

  function all_monitors() result(settings)
    type(monitor_settings_t), allocatable :: settings(:)

    real(wp), parameter :: point(3) = [1.33_wp, 0.21_wp, 0.17_wp], corner(3) = [1.17_wp, 0.11_wp, -0.3_wp]
    real(wp), parameter :: other(3) = [1.52_wp, 0.37_wp, 0.1_wp]

    settings = [ &
      monitor('point', 'point', 'pressure', point, point), &
      monitor('box', 'box', 'pressure', corner, other), &
      monitor('line', 'line', 'pressure', [1.33_wp, 0.0_wp, 0.0_wp], [1.33_wp, 0.6_wp, 0.0_wp], 0.2_wp), &
      monitor('layer', 'plane', 'pressure', [1.0_wp, 0.2_wp, -0.4_wp], [1.8_wp, 0.2_wp, 0.4_wp]), &
      monitor('eps', 'box', 'void_fraction', lower, upper), &
      monitor('wrapped', 'point', 'void_fraction', [1.05_wp, 0.3_wp, 0.4_wp], [1.05_wp, 0.3_wp, 0.4_wp]), &
      monitor('u', 'box', 'gas_velocity', corner, other), &
      monitor('superficial', 'box', 'superficial_velocity', lower, upper), &
      monitor('bottom', 'plane', 'gas_mass_flux', [1.0_wp, 0.0_wp, -0.4_wp], [1.8_wp, 0.0_wp, 0.4_wp]), &
      monitor('half', 'plane', 'gas_mass_flux', [1.0_wp, 0.31_wp, -0.4_wp], [1.35_wp, 0.31_wp, 0.4_wp]), &
      monitor('joined', 'plane', 'gas_mass_flux', [1.0_wp, 0.0_wp, -0.4_wp], [1.8_wp, 0.6_wp, -0.4_wp]), &
      monitor('solids', 'box', 'solids_volume_fraction', corner, other), &
      monitor('v', 'box', 'parcel_velocity', corner, other), &
      monitor('count', 'box', 'parcel_count', corner, other), &
      monitor('particles', 'box', 'particle_count', corner, other), &
      monitor('mass', 'box', 'parcel_mass', corner, other), &
      monitor('x', 'box', 'mean_position', corner, other), &
      monitor('d10', 'box', 'mean_diameter', corner, other), &
      monitor('d32', 'box', 'sauter_diameter', corner, other), &
      monitor('energy', 'box', 'kinetic_energy', corner, other), &
      monitor('theta', 'box', 'granular_temperature', corner, other), &
      monitor('up', 'plane', 'parcel_mass_flux', [1.0_wp, 0.25_wp, -0.4_wp], [1.8_wp, 0.25_wp, 0.4_wp]), &
      monitor('particles_up', 'plane', 'particle_flux', [1.0_wp, 0.25_wp, -0.4_wp], [1.8_wp, 0.25_wp, 0.4_wp]), &
      monitor('nothing', 'box', 'sauter_diameter', [1.0_wp, 0.59_wp, -0.4_wp], upper), &
      monitor('shut', 'box', 'pressure', lower, [1.2_wp, 0.6_wp, 0.4_wp]), &
      monitor('counts', 'line', 'parcel_count', [1.35_wp, 0.0_wp, 0.1_wp], [1.35_wp, 0.6_wp, 0.1_wp])]
  end function all_monitors

  !> Four times, 0.1 s apart. The pressure is linear, the void fraction 0.4 below and 0.8 above y = 0.3 m.
  subroutine measure(space)
    type(open_space_t), intent(in), optional :: space

    type(monitors_t) :: monitors
    type(series_file_t) :: series
    integer :: step
    logical :: due

    call series%open(file, comm, provenance_t('t', 'v', 'c', 'case'), outcome)
    call monitors%create(all_monitors(), unset, mesh, series, boxes=boxes, space=space)
    do step = 0, 3
      due = monitors%any_due(0.1_wp*step)
      if (.not. due) call outcome%fail(1, 'monitors without an interval are not due')
      call measure_fields(monitors, space)
      call measure_cloud(monitors)
      call monitors%record(0.1_wp*step, comm, series)
    end do
    call series%close(outcome)
  end subroutine measure

  !> Velocity component a on its faces is linear in coordinate a; a mass flow is 1000 times its component plus y.
  subroutine measure_fields(monitors, space)
    type(monitors_t), intent(inout) :: monitors
    type(open_space_t), intent(in), optional :: space

    real(wp), allocatable :: p(:,:,:), eps(:,:,:), u(:,:,:,:), flux(:,:,:,:)
    real(wp) :: x(3), face(3)
    integer :: i, j, k, a

    associate (n => boxes%n)
      allocate (p(-1:n(1) + 2, -1:n(2) + 2, -1:n(3) + 2), source=-99.0_wp)
      allocate (u(-1:n(1) + 2, -1:n(2) + 2, -1:n(3) + 2, 3), source=-99.0_wp)
      allocate (eps, source=p)
      allocate (flux, source=u)
      do k = 0, n(3)
        do j = 0, n(2)
          do i = 0, n(1)
            x = lower + (boxes%lo - 1 + [i, j, k] - 0.5_wp)*mesh%finest
            p(i, j, k) = merge(pressure(x), -99.0_wp, all([i, j, k] > 0))
            eps(i, j, k) = merge(0.4_wp, 0.8_wp, x(2) < 0.3_wp)
            do a = 1, 3
              face = x
              face(a) = x(a) + mesh%finest(a)/2
              u(i, j, k, a) = a*face(a)
              flux(i, j, k, a) = 1000*a + face(2)
            end do
          end do
        end do
      end do
    end associate
    call monitors%measure_gas(p, eps, u, flux, space=space)
  end subroutine measure_fields

  !> Walls that close the first three cells in x and half of the fourth, which the gas enters from above.
  function half_closed() result(space)
    type(open_space_t) :: space

    integer :: i

    associate (n => boxes%n)
      allocate (space%volume(-1:n(1) + 2, -1:n(2) + 2, -1:n(3) + 2), source=1.0_wp)
      allocate (space%upper(-1:n(1) + 2, -1:n(2) + 2, -1:n(3) + 2, 3), source=0.5_wp)
      do i = -1, n(1) + 2
        if (boxes%lo(1) + i - 1 < 4) space%volume(i, :, :) = 0.0_wp
        if (boxes%lo(1) + i - 1 == 4) space%volume(i, :, :) = 0.5_wp
        if (boxes%lo(1) + i - 1 == 4) space%upper(i, :, :, 1) = 1.0_wp
      end do
    end associate
  end function half_closed

  !> Means over what is open: of the box 0.5 of cell 4, cell 5 and 0.2 of cell 6, of the 3.5 cells that it is wide.
  subroutine test_open()
    real(wp) :: x(3), u(3), v(3), m, d, w, solids, shut(1)
    integer :: i

    x = box_centre()
    x(1) = lower(1) + 0.1_wp*(0.5_wp*3.5_wp + 4.5_wp + 0.2_wp*5.5_wp)/1.7_wp
    call expect_close(sum(row('box', 'pressure', 1)), pressure(x), 1.0e-12_wp, 'mean over what is open of a box')
    x(1) = lower(1) + 0.1_wp*(0.5_wp*4.0_wp + 4.5_wp + 0.2_wp*5.5_wp)/1.7_wp
    u = row('u', 'gas_velocity', 3)
    call expect(all(abs(u - [1, 2, 3]*x) < 1.0e-12_wp), 'gas velocity there, that of faces by their open areas')
    call expect_close(sum(row('eps', 'void_fraction', 1)), 0.6_wp, 1.0e-12_wp, 'void fraction of what is open')
    call expect_close(sum(row('half', 'gas_mass_flux', 1)), 3.5_wp*4*2000.3_wp, 1.0e-12_wp, 'a flux is what it is')
    solids = 0
    do i = 1, 1000
      call parcel(i, x, v, m, d, w)
      if (any(x < [1.17_wp, 0.11_wp, -0.3_wp] .or. x > [1.52_wp, 0.37_wp, 0.1_wp])) cycle
      solids = solids + w*pi/6*d**3
    end do
    call expect_close(sum(row('solids', 'solids_volume_fraction', 1)), solids/(0.17_wp*0.26_wp*0.4_wp), 1.0e-12_wp, &
                      'solids over what is open')
    shut = row('shut', 'pressure', 1)
    call expect(ieee_is_nan(shut(1)), 'a mean over closed cells is not a number')
  end subroutine test_open

  pure function pressure(x) result(p)
    real(wp), intent(in) :: x(3)
    real(wp) :: p

    p = 1000 + 10*x(1) + 200*x(2) - 3*x(3)
  end function pressure

  !> Parcel i of 1000, wherever it is kept.
  pure subroutine parcel(i, x, v, mass, diameter, weight)
    integer, intent(in) :: i
    real(wp), intent(out) :: x(3), v(3), mass, diameter, weight

    x = lower + (upper - lower)*modulo(i*[0.754877666_wp, 0.569840291_wp, 0.362_wp], 1.0_wp)
    x(2) = x(2)*0.9_wp
    v = [0.1_wp*x(2), 1 - x(1), modulo(i, 7)*0.05_wp]
    diameter = 1.0e-3_wp*(1 + modulo(i, 5))
    weight = 1 + modulo(i, 3)
    mass = weight*2500*pi/6*diameter**3
  end subroutine parcel

  !> Each rank has every comm%size-th parcel.
  subroutine measure_cloud(monitors)
    type(monitors_t), intent(inout) :: monitors

    real(wp) :: x(3, 1000), v(3, 1000), mass(1000), diameter(1000), weight(1000)
    integer :: i, n

    n = 0
    do i = 1 + comm%rank, 1000, comm%size
      n = n + 1
      call parcel(i, x(:, n), v(:, n), mass(n), diameter(n), weight(n))
    end do
    call monitors%measure_parcels(x(:, :n), v(:, :n), 1/mass(:n), diameter(:n), weight(:n))
  end subroutine measure_cloud

  !> The first row of a monitor.
  function row(id, quantity, width) result(values)
    character(len=*), intent(in) :: id, quantity
    integer, intent(in) :: width
    real(wp) :: values(width)

    type(hdf5_file_t) :: h5
    type(outcome_t) :: reading
    integer(i8), allocatable :: extent(:)
    real(wp), allocatable :: table(:,:), column(:)

    call h5%open(file, .false.)
    allocate (extent, source=h5%shape_of('/monitors/'//id//'/'//quantity))
    values = -1.0e30_wp
    if (product(extent(:size(extent) - 1)) == width) then
      allocate (table(width, 1), column(1))
      if (width > 1) call get_columns(h5, '/monitors/'//id//'/'//quantity, table, 0_i8)
      if (width > 1) values = table(:, 1)
      if (width == 1) call get_columns(h5, '/monitors/'//id//'/'//quantity, column, 0_i8)
      if (width == 1) values = column
    end if
    call h5%close(reading)
    call expect(.not. reading%failed(), id//' is in the file')
  end function row

  subroutine test_gas()
    real(wp) :: line(12), u(3), superficial(3)
    integer :: i

    call expect_close(sum(row('point', 'pressure', 1)), pressure([1.33_wp, 0.21_wp, 0.17_wp]), 1.0e-12_wp, &
                      'a linear field at a point')
    call expect_close(sum(row('layer', 'pressure', 1)), pressure([1.4_wp, 0.2_wp, 0.0_wp]), 1.0e-12_wp, &
                      'its mean over a plane')
    line = row('line', 'pressure', 12)
    do i = 1, 12
      call expect_close(line(i), pressure([1.33_wp, 0.05_wp*(i - 0.5_wp), 0.0_wp]), 1.0e-12_wp, 'along a line')
    end do
    call expect_close(sum(row('box', 'pressure', 1)), box_mean(), 1.0e-12_wp, 'mean over a box that cuts cells')
    call expect_close(sum(row('eps', 'void_fraction', 1)), 0.6_wp, 1.0e-12_wp, 'mean void fraction of the domain')
    call expect_close(sum(row('wrapped', 'void_fraction', 1)), 0.6_wp, 1.0e-12_wp, 'a point on a joined face')
    u = row('u', 'gas_velocity', 3)
    call expect(all(abs(u - [1, 2, 3]*box_centre()) < 1.0e-12_wp), 'gas velocity in a box')
    superficial = row('superficial', 'superficial_velocity', 3)
    call expect_close(superficial(1), 0.6_wp*1.4_wp, 1.0e-12_wp, 'superficial velocity across the steps of void fraction')
    call expect_close(superficial(2), 0.5_wp*(0.4_wp*0.3_wp + 0.8_wp*0.9_wp), 1.0e-12_wp, 'and along them')
  end subroutine test_gas

  !> Mean coordinates of the box of the monitors when every cell counts with the part inside, at its centre.
  function box_centre() result(x)
    real(wp) :: x(3)

    ! x: 0.3 of cell 2, cells 3 to 5, 0.2 of cell 6; y: 0.8 of cell 3, 4 to 7, 0.4 of 8; z: half of 1, 2, half of 3
    x(1) = lower(1) + 0.1_wp*(0.3_wp*1.5_wp + 2.5_wp + 3.5_wp + 4.5_wp + 0.2_wp*5.5_wp)/3.5_wp
    x(2) = 0.05_wp*(0.8_wp*2.5_wp + 3.5_wp + 4.5_wp + 5.5_wp + 6.5_wp + 0.4_wp*7.5_wp)/5.2_wp
    x(3) = lower(3) + 0.2_wp*(0.5_wp*0.5_wp + 1.5_wp + 0.5_wp*2.5_wp)/2
  end function box_centre

  function box_mean() result(p)
    real(wp) :: p

    p = pressure(box_centre())
  end function box_mean

  subroutine test_planes()
    call expect_close(sum(row('bottom', 'gas_mass_flux', 1)), 32*2000.0_wp, 1.0e-12_wp, 'gas through the floor')
    ! The nearest faces are at 0.3 m; the part up to 1.35 m is 3.5 of 8 cells in x.
    call expect_close(sum(row('half', 'gas_mass_flux', 1)), 3.5_wp*4*2000.3_wp, 1.0e-12_wp, 'through part of a plane')
    call expect_close(sum(row('joined', 'gas_mass_flux', 1)), 8*12*3000.3_wp, 1.0e-12_wp, 'through a joined face')
  end subroutine test_planes

  subroutine test_parcels()
    real(wp) :: x(3), v(3), m, d, w, s(20), empty(1), counts(12)
    integer :: i
    real(wp), parameter :: volume = 0.35_wp*0.26_wp*0.4_wp

    s = 0
    do i = 1, 1000
      call parcel(i, x, v, m, d, w)
      if (abs(x(2) - 0.25_wp) < 0.025_wp) s(18:19) = s(18:19) + [m, w]*v(2)/0.05_wp
      if (any(x < [1.17_wp, 0.11_wp, -0.3_wp] .or. x > [1.52_wp, 0.37_wp, 0.1_wp])) cycle
      s = s + [m, m*v, m*x, m*dot_product(v, v), w, w*d, w*d**2, w*d**3, 1.0_wp, w*pi/6*d**3, spread(0.0_wp, 1, 6)]
    end do
    call expect_close(sum(row('solids', 'solids_volume_fraction', 1)), s(14)/volume, 1.0e-12_wp, 'solids volume fraction')
    call expect(all(abs(row('v', 'parcel_velocity', 3) - s(2:4)/s(1)) < 1.0e-12_wp), 'mean velocity')
    call expect_close(sum(row('count', 'parcel_count', 1)), s(13), 0.0_wp, 'parcels')
    call expect_close(sum(row('particles', 'particle_count', 1)), s(9), 1.0e-12_wp, 'particles')
    call expect_close(sum(row('mass', 'parcel_mass', 1)), s(1), 1.0e-12_wp, 'mass')
    call expect(all(abs(row('x', 'mean_position', 3) - s(5:7)/s(1)) < 1.0e-12_wp), 'centre of mass')
    call expect_close(sum(row('d10', 'mean_diameter', 1)), s(10)/s(9), 1.0e-12_wp, 'number mean diameter')
    call expect_close(sum(row('d32', 'sauter_diameter', 1)), s(12)/s(11), 1.0e-12_wp, 'Sauter diameter')
    call expect_close(sum(row('energy', 'kinetic_energy', 1)), s(8)/2, 1.0e-12_wp, 'kinetic energy')
    call expect_close(sum(row('theta', 'granular_temperature', 1)), (s(8)/s(1) - sum((s(2:4)/s(1))**2))/3, 1.0e-11_wp, &
                      'granular temperature')
    call expect_close(sum(row('up', 'parcel_mass_flux', 1)), s(18), 1.0e-12_wp, 'mass flux of parcels')
    call expect_close(sum(row('particles_up', 'particle_flux', 1)), s(19), 1.0e-12_wp, 'flux of particles')
    empty = row('nothing', 'sauter_diameter', 1)
    call expect(ieee_is_nan(empty(1)), 'a mean over nothing is not a number')
    counts = row('counts', 'parcel_count', 12)
    call expect(sum(counts) > 1 .and. abs(sum(counts) - in_column()) < 0.5_wp, 'parcels along a line')
  end subroutine test_parcels

  !> Parcels within half a cell of the line.
  function in_column() result(n)
    real(wp) :: n

    real(wp) :: x(3), v(3), m, d, w
    integer :: i

    n = 0
    do i = 1, 1000
      call parcel(i, x, v, m, d, w)
      if (abs(x(1) - 1.35_wp) < 0.05_wp .and. abs(x(3) - 0.1_wp) < 0.1_wp) n = n + 1
    end do
  end function in_column

  !> A monitor with an interval of 0.2 s has half the rows.
  subroutine test_times()
    type(hdf5_file_t) :: h5
    type(outcome_t) :: reading
    integer(i8) :: rows(2)

    call h5%open(file, .false.)
    rows = [product(h5%shape_of('/monitors/point/time')), product(h5%shape_of('/monitors/line/time'))]
    call h5%close(reading)
    call expect(all(rows == [4, 2]), 'monitors keep their own intervals')
  end subroutine test_times

end program test_monitors
