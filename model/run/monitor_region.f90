!> The region of a monitor: which of my gas cells and which parcels belong to it, and by how much.
!>
!> Of the gas: a mean over what is open to it. Along a direction in which the region has an extent, a cell counts by how much
!> of it is inside; along a direction in which it has none, the two cells around it count as in linear interpolation between
!> their centres. The weights of all cells of all ranks add up to 1; where walls block the gas a cell counts by its weight times
!> its open part, and the sum is divided by that of the open parts. Through a plane: the faces nearest to it count by how much
!> of them is inside.
!> Of parcels: those with their centre in the region, which is made one gas cell thick where it has no extent.
module monitor_region
  use boxes, only: boxes_t
  use grid_axis, only: axis_t
  use kinds, only: wp
  use mesh, only: mesh_t
  use open_space, only: open_space_t
  implicit none
  private
  public :: sample_t, new_samples, weigh_cells, weigh_faces, weighted_sum

  !> One place of a region: the pieces of a line, otherwise all of it.
  type :: sample_t
    real(wp) :: lower(3), upper(3)       !< corners, without thickness [m]
    real(wp) :: low(3), high(3)          !< corners of what holds its parcels [m]
    integer :: first(3), last(3)         !< my cells with a weight; none if last < first
    real(wp), allocatable :: weight(:,:)  !< (cell from first(a), a); the weight of a cell is their product
  end type sample_t

contains

  !> Cut a line into pieces about as long as a cell; any other region is one sample.
  pure function new_samples(mesh, kind, lower, upper) result(samples)
    type(mesh_t), intent(in) :: mesh
    character(len=*), intent(in) :: kind
    real(wp), intent(in) :: lower(3), upper(3)  !< corners [m]
    type(sample_t), allocatable :: samples(:)

    integer :: i, n
    real(wp) :: thickness(3)

    n = 1
    if (kind == 'line') n = max(1, nint(maxval(mesh%in_cells(upper) - mesh%in_cells(lower))))
    allocate (samples(n))
    do i = 1, n
      associate (s => samples(i))
        s%lower = lower + (i - 1)*(upper - lower)/n
        s%upper = lower + i*(upper - lower)/n
        thickness = merge(0.0_wp, width_at(mesh, s%lower), upper > lower)
        s%low = max(s%lower - thickness/2, mesh%lower)
        s%high = min(s%upper + thickness/2, mesh%upper)
        s%first = 1
        s%last = 0
      end associate
    end do
  end function new_samples

  !> Find the weights of my cells for a mean.
  pure subroutine weigh_cells(sample, boxes, mesh)
    type(sample_t), intent(inout) :: sample
    type(boxes_t), intent(in) :: boxes
    type(mesh_t), intent(in) :: mesh

    real(wp) :: all_cells(maxval(mesh%n), 3)
    integer :: a

    do a = 1, 3
      associate (n => mesh%n(a), from => sample%lower(a), to => sample%upper(a))
        all_cells(:, a) = 0.0_wp
        if (to > from) all_cells(:n, a) = shares(mesh%axis(a), from, to)/(to - from)
        if (to <= from) all_cells(:n, a) = interpolation(n, mesh%axis(a)%in_cells(from), mesh%periodic(a))
      end associate
    end do
    call keep_mine(sample, boxes, all_cells)
  end subroutine weigh_cells

  !> Find the weights of the high faces of my cells, or of the low faces of the domain, for a sum over a plane.
  pure subroutine weigh_faces(sample, boxes, mesh)
    type(sample_t), intent(inout) :: sample
    type(boxes_t), intent(in) :: boxes
    type(mesh_t), intent(in) :: mesh

    real(wp) :: all_cells(maxval(mesh%n), 3)
    integer :: a, normal, face

    all_cells = 0.0_wp
    normal = minloc(sample%upper - sample%lower, dim=1)
    do a = 1, 3
      if (a == normal) cycle
      all_cells(:mesh%n(a), a) = shares(mesh%axis(a), sample%lower(a), sample%upper(a))/mesh%axis(a)%width(1:mesh%n(a))
    end do
    face = nint(mesh%axis(normal)%in_cells(sample%lower(normal)))
    if (face == 0 .and. mesh%periodic(normal)) face = mesh%n(normal)
    all_cells(max(face, 1), normal) = 1.0_wp
    call keep_mine(sample, boxes, all_cells)
    if (face > 0) return
    ! The low face of the first cell has the index of the cell below it, which is none.
    sample%first(normal) = 0
    sample%last(normal) = merge(0, -1, boxes%at_low(normal))
  end subroutine weigh_faces

  !> How much of each cell lies between two places, all in metres.
  pure function shares(axis, from, to) result(share)
    type(axis_t), intent(in) :: axis
    real(wp), intent(in) :: from, to
    real(wp) :: share(axis%n)

    integer :: i

    share = [(max(min(to, axis%face(i)) - max(from, axis%face(i - 1)), 0.0_wp), i=1, axis%n)]
  end function shares

  !> Widths of the cell that holds a place [m].
  pure function width_at(mesh, x) result(width)
    type(mesh_t), intent(in) :: mesh
    real(wp), intent(in) :: x(3)  !< [m]
    real(wp) :: width(3)

    integer :: a, cell(3)

    cell = min(max(ceiling(mesh%in_cells(x)), 1), mesh%n)
    width = [(mesh%axis(a)%width(cell(a)), a=1, 3)]
  end function width_at

  !> The weights of n cells in a linear interpolation between their centres, constant beyond the last centres.
  pure function interpolation(n, place, periodic) result(weight)
    integer, intent(in) :: n
    real(wp), intent(in) :: place  !< in units of a cell
    logical, intent(in) :: periodic
    real(wp) :: weight(n)

    integer :: below, pair(2)
    real(wp) :: fraction

    below = floor(place + 0.5_wp)
    fraction = place + 0.5_wp - below
    pair = min(max([below, below + 1], 1), n)
    if (periodic) pair = 1 + modulo([below, below + 1] - 1, n)
    weight = 0.0_wp
    weight(pair(1)) = 1 - fraction
    weight(pair(2)) = weight(pair(2)) + fraction
  end function interpolation

  !> Of the weights of all cells along each axis, keep the range of my cells that has any.
  pure subroutine keep_mine(sample, boxes, all_cells)
    type(sample_t), intent(inout) :: sample
    type(boxes_t), intent(in) :: boxes
    real(wp), intent(in) :: all_cells(:,:)

    integer :: a, i

    do a = 1, 3
      sample%first(a) = boxes%n(a) + 1
      sample%last(a) = 0
      do i = 1, boxes%n(a)
        if (all_cells(boxes%lo(a) + i - 1, a) <= 0.0_wp) cycle
        sample%first(a) = min(sample%first(a), i)
        sample%last(a) = i
      end do
    end do
    allocate (sample%weight(max(0, maxval(sample%last - sample%first + 1)), 3), source=0.0_wp)
    do a = 1, 3
      do i = sample%first(a), sample%last(a)
        sample%weight(i - sample%first(a) + 1, a) = all_cells(boxes%lo(a) + i - 1, a)
      end do
    end do
  end subroutine keep_mine

  !> Sum of the weights times a field over my cells. With an axis, the field is on the faces across it and a cell has
  !> the mean of its two, by their open areas. `scale`, if given, is another factor of each cell.
  pure function weighted_sum(sample, f, axis, scale, space) result(total)
    type(sample_t), intent(in) :: sample
    real(wp), intent(in) :: f(-1:, -1:, -1:)                    !< my box with two layers of halo
    integer, intent(in), optional :: axis
    real(wp), intent(in), optional :: scale(-1:, -1:, -1:)
    type(open_space_t), intent(in), optional :: space
    real(wp) :: total

    integer :: i, j, k, e(3)
    real(wp) :: w, upper

    total = 0.0_wp
    upper = 0.5_wp
    e = 0
    if (present(axis)) e(axis) = 1
    associate (lo => sample%first - 1)
      do k = sample%first(3), sample%last(3)
        do j = sample%first(2), sample%last(2)
          do i = sample%first(1), sample%last(1)
            w = sample%weight(i - lo(1), 1)*sample%weight(j - lo(2), 2)*sample%weight(k - lo(3), 3)
            if (present(scale)) w = w*scale(i, j, k)
            if (present(space)) w = w*space%volume(i, j, k)
            if (present(space) .and. present(axis)) upper = space%upper(i, j, k, axis)
            total = total + w*(upper*f(i, j, k) + (1 - upper)*f(i - e(1), j - e(2), k - e(3)))
          end do
        end do
      end do
    end associate
  end function weighted_sum

end module monitor_region
