!> The trilinear mapping: weights sum to one everywhere, linear fields are exact, nothing is lost at walls.
program test_coupling_mapping
  use check, only: expect, expect_close, finish
  use grid_axis, only: axis_t, graded_axis, graded_faces
  use kinds, only: wp
  use mapping, only: locate, interpolate, deposit, deposit_sources, lanes, source_lanes
  use mesh, only: mesh_t, new_mesh, new_uniform_mesh
  use window, only: window_t, new_window
  implicit none

  integer, parameter :: n = 500
  real(wp), parameter :: lower(3) = [-0.2_wp, 1.0_wp, 0.3_wp], upper(3) = [0.8_wp, 2.5_wp, 0.7_wp]
  real(wp) :: position(8, n), fraction(3, n)
  integer :: corner(n), grid
  logical :: graded
  type(mesh_t) :: mesh

  graded = .false.
  call check_known_place()
  do grid = 1, 2
    graded = grid == 2
    call check_unity([5, 6, 4], [.false., .false., .false.], 'walls')
    call check_unity([5, 6, 4], [.true., .true., .true.], 'periodic')
    call check_unity([5, 6, 1], [.true., .false., .false.], 'one cell thick')
    call check_unity([5, 1, 1], [.true., .false., .true.], 'one cell thick twice')
  end do
  call check_even_solids()
  graded = .false.
  call check_linear()
  call check_wall()
  call check_beyond()
  call finish()

contains

  function whole_domain(cells, periodic, margin) result(window)
    integer, intent(in) :: cells(3)
    logical, intent(in) :: periodic(3)
    real(wp), intent(in) :: margin
    type(window_t) :: window

    integer :: a
    real(wp) :: corners(3, 2, 1)

    mesh = new_uniform_mesh(lower, upper, cells, periodic)
    if (graded) mesh = new_mesh([(squeezed(mesh%axis(a)), a=1, 3)])
    corners(:, 1, 1) = mesh%in_cells(lower - margin)
    corners(:, 2, 1) = mesh%in_cells(upper + margin)
    window = new_window(cells, periodic, corners)
  end function whole_domain

  !> The same cells, each 1.2 times as wide as the one before.
  pure function squeezed(axis)
    type(axis_t), intent(in) :: axis
    type(axis_t) :: squeezed

    squeezed = graded_axis(graded_faces([axis%lower, axis%upper], [axis%n], [1.2_wp**(axis%n - 1)]), axis%periodic)
  end function squeezed

  !> Solids spread evenly in space give every cell a volume near to its own, on a graded axis up to the second difference
  !> of the widths: (w_below - 2 w + w_above)/8, here (1/1.2 - 2 + 1.2)/8 of a cell.
  subroutine check_even_solids()
    integer, parameter :: many = 1200
    type(window_t) :: window
    real(wp) :: place(3, many), part(3, many)
    real(wp), allocatable :: field(:)
    integer :: at(many), outside, i

    graded = .true.
    window = whole_domain([1, 6, 1], [.false., .false., .false.], 0.0_wp)
    place = spread(0.5_wp*(lower + upper), 2, many)
    place(2, :) = [(lower(2) + (i - 0.5_wp)/many*(upper(2) - lower(2)), i=1, many)]
    call locate(mesh, window, place, at, part, outside)
    allocate (field(window%cells()), source=0.0_wp)
    call deposit(window, at, part, spread((upper(2) - lower(2))/many, 1, many), field)
    associate (width => mesh%axis(2)%width)
      do i = 2, 5
        call expect_close(field(1 + window%n(1)*(i - 1))/width(i), 1 + (1/1.2_wp - 2 + 1.2_wp)/8, 1.0e-3_wp, &
                          'solids of a graded cell')
      end do
    end associate
  end subroutine check_even_solids

  !> Random places in the whole domain, up to `beyond` of its size outside; two in its corners.
  subroutine scatter_places(beyond)
    real(wp), intent(in) :: beyond

    integer :: i

    position = 0.0_wp
    call random_number(position(1:3, :))
    position(1:3, :) = (1.0_wp + 2.0_wp*beyond)*position(1:3, :) - beyond
    position(1:3, 1) = max(0.0_wp, -beyond)
    position(1:3, 2) = min(1.0_wp, 1.0_wp + beyond)
    position(1:3, 3) = 0.5_wp
    do i = 1, n
      position(1:3, i) = lower + (upper - lower)*position(1:3, i)
    end do
  end subroutine scatter_places

  !> A parcel a quarter, a half and no cell beyond a centre.
  subroutine check_known_place()
    type(window_t) :: window
    real(wp), allocatable :: field(:), source(:,:)
    real(wp) :: h(3), place(3, 1)
    integer :: outside, last, at(4)

    window = whole_domain([4, 4, 4], [.false., .false., .false.], 0.0_wp)
    h = mesh%finest
    place(:, 1) = lower + h*([2, 1, 3] - 0.5_wp + [0.25_wp, 0.5_wp, 0.0_wp])
    call locate(mesh, window, place, corner(1:1), fraction(:, 1:1), outside)
    allocate (field(64), source(source_lanes, 64), source=0.0_wp)
    call deposit(window, corner(1:1), fraction(:, 1:1), [8.0_wp], field)
    last = 2 + 4*(0 + 4*2)
    at = [last, last + 1, last + 4, last + 5]
    call expect(all(abs(field(at) - [3, 1, 3, 1]) < 1e-13_wp), 'known weights of a known place')
    call expect_close(sum(abs(field)), 8.0_wp, 1e-14_wp, 'and none elsewhere')
    call deposit_sources(window, corner(1:1), fraction(:, 1:1), &
                         reshape([8.0_wp, -8.0_wp, 16.0_wp, 0.0_wp], [4, 1]), source)
    call expect(all(abs(source(1, :) - field) + abs(source(2, :) + field) + abs(source(3, :) - 2*field) < 1e-13_wp), &
                'several components take the same weights')
  end subroutine check_known_place

  subroutine check_unity(cells, periodic, name)
    integer, intent(in) :: cells(3)
    logical, intent(in) :: periodic(3)
    character(len=*), intent(in) :: name

    type(window_t) :: window
    real(wp), allocatable :: field(:,:), given(:), value(:,:)
    integer :: outside

    window = whole_domain(cells, periodic, 0.2_wp)
    call scatter_places(0.1_wp)
    call locate(mesh, window, position, corner, fraction, outside)
    call expect(outside == 0, 'every parcel is in the window, '//name)
    allocate (field(lanes, window%cells()), value(lanes, n), given(window%cells()), source=0.0_wp)
    field = spread(merge(1.0_wp, 0.0_wp, window%wanted), 1, lanes)
    call interpolate(window, corner, fraction, field, value)
    call expect(all(abs(value - 1.0_wp) < 4*epsilon(1.0_wp)), 'weights on true cells sum to one, '//name)
    call deposit(window, corner, fraction, spread(2.0_wp, 1, n), given)
    call expect_close(sum(given, window%wanted), 2.0_wp*n, 1e-13_wp, 'all that is deposited is in true cells, '//name)
    call expect(all(given >= 0.0_wp), 'no weight is negative, '//name)
  end subroutine check_unity

  !> Between the outermost centres a linear field is exact.
  subroutine check_linear()
    type(window_t) :: window
    real(wp), allocatable :: field(:,:), value(:,:)
    real(wp), parameter :: slope(3) = [1.3_wp, -0.7_wp, 2.9_wp]
    real(wp) :: error
    integer :: i, c, cells(3), outside

    cells = [5, 6, 4]
    window = whole_domain(cells, [.false., .false., .false.], 0.0_wp)
    call scatter_places(-0.126_wp)
    call locate(mesh, window, position, corner, fraction, outside)
    allocate (field(lanes, window%cells()), value(lanes, n), source=0.0_wp)
    do c = 1, window%cells()
      field(:, c) = [(i*(4.0_wp + dot_product(slope, lower + mesh%finest*(window%cell_at(c) - 0.5_wp))), i=1, lanes)]
    end do
    call interpolate(window, corner, fraction, field, value)
    error = 0.0_wp
    do i = 1, n
      error = max(error, abs(value(1, i) - 4.0_wp - dot_product(slope, position(1:3, i))), &
                  abs(value(8, i) - 8*value(1, i)))
    end do
    call expect_close(error, 0.0_wp, 1e-13_wp, 'a linear field is interpolated exactly')
  end subroutine check_linear

  !> Half a cell from a wall and nearer, a parcel belongs to the wall's cell alone.
  subroutine check_wall()
    type(window_t) :: window
    real(wp), allocatable :: field(:)
    real(wp) :: place(3, 1)
    integer :: outside

    window = whole_domain([4, 4, 4], [.false., .false., .false.], 0.0_wp)
    allocate (field(64), source=0.0_wp)
    place(:, 1) = upper - 0.4_wp*mesh%finest
    call locate(mesh, window, place, corner(1:1), fraction(:, 1:1), outside)
    call deposit(window, corner(1:1), fraction(:, 1:1), [1.0_wp], field)
    call expect_close(field(64), 1.0_wp, 0.0_wp, 'a parcel in the corner belongs to its cell')
  end subroutine check_wall

  !> A parcel beyond the window along a periodic direction is counted.
  subroutine check_beyond()
    type(window_t) :: window
    real(wp) :: place(3, 2)
    integer :: outside

    window = whole_domain([4, 4, 4], [.true., .false., .false.], 0.1_wp)
    place(:, 1) = lower - [0.4_wp, 0.0_wp, 0.0_wp]
    place(:, 2) = lower - [0.0_wp, 0.4_wp, 0.0_wp]
    call locate(mesh, window, place, corner(1:2), fraction(:, 1:2), outside)
    call expect(outside == 1, 'a parcel beyond the window is counted')
  end subroutine check_beyond

end program test_coupling_mapping
