!> Set-ups that are mirrored, turned or moved across a periodic face: the results are, too, to round-off.
program verify_symmetry
  use chamber, only: chamber_t
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use check, only: expect, finish
  use contact_settings, only: contact_settings_t
  use des_scenes, only: cloud, place_of, put, run
  use des_settings, only: des_settings_t
  use kinds, only: wp
  use report, only: check_value
  use solids, only: solids_t
  implicit none

  integer, parameter :: n = 200, steps = 400
  real(wp), parameter :: edge = 0.01_wp
  type(communicator_t) :: comm

  call start_ranks(comm)
  call mirrored_and_turned('linear')
  call mirrored_and_turned('hertz')
  call across_faces('linear')
  call across_faces('hertz')
  call finish()
  call stop_ranks()

contains

  function material(law) result(contact)
    character(len=*), intent(in) :: law
    type(contact_settings_t) :: contact

    contact%law = law
    contact%stiffness = 500.0_wp
    contact%youngs_modulus = 1.0e7_wp
    contact%poisson_ratio = 0.3_wp
    contact%friction = 0.4_wp
    contact%wall_friction = 0.2_wp
  end function material

  !> A cube about the origin.
  function cube(law, gravity, periodic) result(solids)
    character(len=*), intent(in) :: law
    real(wp), intent(in) :: gravity(3)
    logical, intent(in) :: periodic
    type(solids_t) :: solids

    type(chamber_t) :: chamber

    chamber%lower = -edge/2
    chamber%upper = edge/2
    chamber%gravity = gravity
    chamber%periodic = periodic
    call solids%create(comm, chamber, material(law), des_settings_t(), .false., 0.0_wp)
  end function cube

  !> Rough parcels that fall into a corner of the cube, and the same after x -> -x, and after a quarter turn about z,
  !> (x, y) -> (-y, x): the largest difference of places over the diameter, of velocities and of spins over the largest
  !> speed, of which the mirror changes sign across x alone.
  subroutine mirrored_and_turned(law)
    character(len=*), intent(in) :: law

    real(wp), parameter :: gravity(3) = [20.0_wp, -30.0_wp, -80.0_wp]
    real(wp), parameter :: mirror(3) = [-1.0_wp, 1.0_wp, 1.0_wp]
    real(wp), allocatable :: x(:,:), v(:,:), d(:), plain(:,:), other(:,:), expected(:,:)

    call cloud(n, [-0.0048_wp, -0.0048_wp, -0.0048_wp], 1.35e-3_wp, [7, 7], x, v, d)
    call fall(law, gravity, x, v, d, plain)
    call fall(law, mirror*gravity, spread(mirror, 2, n)*x, spread(mirror, 2, n)*v, d, other)
    expected = plain
    expected([1, 4], :) = -expected([1, 4], :)
    expected(8:9, :) = -expected(8:9, :)
    call expect(count(sum(plain(7:9, :)**2, 1) > 0) > n/2, 'most parcels have met others')
    call check_value('mirrored_'//law, distance(other, expected), 0.0_wp)
    call fall(law, turned(gravity), turned_all(x), turned_all(v), d, other)
    expected(1:3, :) = turned_all(plain(1:3, :))
    expected(4:6, :) = turned_all(plain(4:6, :))
    expected(7:9, :) = turned_all(plain(7:9, :))
    call check_value('turned_'//law, distance(other, expected), 0.0_wp)
  end subroutine mirrored_and_turned

  !> Place over diameter, velocity and spin over speed, the largest difference.
  pure function distance(a, b)
    real(wp), intent(in) :: a(:,:), b(:,:)
    real(wp) :: distance

    distance = max(maxval(abs(a(1:3, :) - b(1:3, :)))/1.0e-3_wp, &
                   maxval(abs(a(4:9, :) - b(4:9, :)))/sqrt(maxval(sum(b(4:6, :)**2, 1))))
  end function distance

  pure function turned(a) result(b)
    real(wp), intent(in) :: a(3)
    real(wp) :: b(3)

    b = [-a(2), a(1), a(3)]
  end function turned

  pure function turned_all(a) result(b)
    real(wp), intent(in) :: a(:,:)
    real(wp) :: b(size(a, 1), size(a, 2))

    integer :: i

    do i = 1, size(a, 2)
      b(:, i) = turned(a(:, i))
    end do
  end function turned_all

  !> Places, velocities and spins at the end, by number.
  subroutine fall(law, gravity, x, v, d, rows)
    character(len=*), intent(in) :: law
    real(wp), intent(in) :: gravity(3), x(:,:), v(:,:), d(:)
    real(wp), allocatable, intent(out) :: rows(:,:)

    type(solids_t) :: solids

    solids = cube(law, gravity, .false.)
    call put(solids, x, v, d)
    call run(solids, steps, solids%time_step_limit())
    rows = by_number(solids, size(d))
  end subroutine fall

  pure function by_number(solids, count) result(rows)
    type(solids_t), intent(in) :: solids
    integer, intent(in) :: count
    real(wp) :: rows(9, count)

    integer :: i

    do i = 1, count
      associate (s => solids%parcels%state(:, place_of(solids, i)))
        rows(:, i) = [s(1:3), s(5:7), s(9:11)]
      end associate
    end do
  end function by_number

  !> Two rough parcels that meet inside, and across a face, an edge and a corner of the periodic cube.
  subroutine across_faces(law)
    character(len=*), intent(in) :: law

    real(wp), parameter :: still(3) = 0.0_wp, shift(3) = [0.0047_wp, 0.0049_wp, 0.0048_wp]
    type(solids_t) :: solids
    real(wp) :: x(3, 2), v(3, 2), inside(9, 2), across(9, 2), worst
    integer :: faces

    worst = 0
    do faces = 0, 3
      x(:, 1) = [-0.0002_wp, 0.0001_wp, 0.0_wp]
      x(:, 2) = [0.0006_wp, 0.0006_wp, 0.0004_wp]
      v(:, 1) = [0.3_wp, 0.1_wp, 0.0_wp]
      v(:, 2) = [-0.3_wp, 0.0_wp, -0.05_wp]
      x(:faces, :) = x(:faces, :) + spread(shift(:faces), 2, 2)
      x = x - edge*nint(x/edge)
      solids = cube(law, still, .true.)
      call put(solids, x, v, [1.0e-3_wp, 1.2e-3_wp])
      call run(solids, steps, solids%time_step_limit())
      across = by_number(solids, 2)
      if (faces == 0) inside = across
      worst = max(worst, maxval(abs(across(4:9, :) - inside(4:9, :)))/0.3_wp)
    end do
    call check_value('across_face_'//law, worst, 0.0_wp)
    call expect(norm2(inside(7:9, 1)) > 0.01_wp, 'the two have met')
  end subroutine across_faces

end program verify_symmetry
