!> One direction of the grid: where its faces are.
!>
!> Cells may have widths of their own. Places are also counted in cells: s = i at face i, linear within a cell, so the
!> centre of cell i is at s = i - 1/2. Along a periodic axis s goes on beyond the ends, cell by image of a cell.
module grid_axis
  use kinds, only: wp
  implicit none
  private
  public :: axis_t, uniform_axis, graded_axis, graded_faces

  integer, parameter :: halo = 2  !< cells beyond the ends whose widths are known

  type :: axis_t
    integer :: n = 0                      !< cells
    logical :: periodic = .false.         !< whether the ends are joined
    logical :: uniform = .true.           !< all cells equally wide
    real(wp) :: lower = 0.0_wp            !< [m]
    real(wp) :: upper = 0.0_wp            !< [m]
    real(wp) :: finest = 0.0_wp           !< width of the thinnest cell [m]
    real(wp) :: coarsest = 0.0_wp         !< and of the widest [m]
    real(wp), allocatable :: face(:)      !< (0:n) [m]
    real(wp), allocatable :: width(:)     !< (-1:n+2) of the cells, beyond the ends of their images or mirror images [m]
    real(wp), allocatable :: gap(:)       !< (-1:n+1) between the centres of a cell and the next one [m]
  contains
    procedure :: in_cells
    procedure :: in_metres
    procedure, private :: cell_of
  end type axis_t

contains

  pure function uniform_axis(lower, upper, n, periodic) result(axis)
    real(wp), intent(in) :: lower, upper  !< ends [m]
    integer, intent(in) :: n              !< cells
    logical, intent(in) :: periodic
    type(axis_t) :: axis

    integer :: i

    axis = graded_axis([(lower + i*((upper - lower)/n), i=0, n - 1), upper], periodic)
    axis%uniform = .true.
    axis%width = (upper - lower)/n
    axis%gap = (upper - lower)/n
    axis%finest = (upper - lower)/n
    axis%coarsest = (upper - lower)/n
  end function uniform_axis

  pure function graded_axis(face, periodic) result(axis)
    real(wp), intent(in) :: face(0:)  !< rising [m]
    logical, intent(in) :: periodic
    type(axis_t) :: axis

    integer :: i, n

    n = ubound(face, 1)
    axis%n = n
    axis%periodic = periodic
    axis%uniform = .false.
    axis%lower = face(0)
    axis%upper = face(n)
    allocate (axis%face(0:n), source=face)
    allocate (axis%width(1 - halo:n + halo), axis%gap(1 - halo:n + halo - 1))
    axis%width(1:n) = face(1:n) - face(0:n - 1)
    do i = 1, halo
      axis%width(1 - i) = axis%width(merge(1 + modulo(-i, n), min(i, n), periodic))
      axis%width(n + i) = axis%width(merge(1 + modulo(i - 1, n), max(n + 1 - i, 1), periodic))
    end do
    axis%gap = 0.5_wp*(axis%width(:n + halo - 1) + axis%width(2 - halo:))
    axis%finest = minval(axis%width(1:n))
    axis%coarsest = maxval(axis%width(1:n))
  end function graded_axis

  !> Faces of segments between break points; within one the widths grow by a constant factor.
  pure function graded_faces(breaks, cells, ratios) result(face)
    real(wp), intent(in) :: breaks(0:)  !< ends of the segments, rising [m]
    integer, intent(in) :: cells(:)     !< of each segment
    real(wp), intent(in) :: ratios(:)   !< last width of a segment over its first [-]
    real(wp) :: face(0:sum(cells))

    integer :: i, m, first
    real(wp) :: growth, sum_of_widths, widths(maxval(cells))

    face(0) = breaks(0)
    first = 0
    do m = 1, size(cells)
      growth = ratios(m)**(1.0_wp/max(1, cells(m) - 1))
      widths(:cells(m)) = [(growth**i, i=0, cells(m) - 1)]
      sum_of_widths = sum(widths(:cells(m)))
      do i = 1, cells(m) - 1
        face(first + i) = breaks(m - 1) + (breaks(m) - breaks(m - 1))*(sum(widths(:i))/sum_of_widths)
      end do
      first = first + cells(m)
      face(first) = breaks(m)
    end do
  end function graded_faces

  !> A place counted in cells; beyond the ends the cells go on as wide as the last, or as images.
  pure function in_cells(self, x) result(s)
    class(axis_t), intent(in) :: self
    real(wp), intent(in) :: x  !< [m]
    real(wp) :: s

    integer :: cell, turns
    real(wp) :: inside

    if (self%uniform) then
      s = (x - self%lower)*(1.0_wp/self%coarsest)
      return
    end if
    inside = x
    turns = 0
    if (self%periodic) then
      turns = floor((x - self%lower)/(self%upper - self%lower))
      inside = x - turns*(self%upper - self%lower)
    end if
    cell = self%cell_of(inside)
    s = turns*self%n + cell - 1 + (inside - self%face(cell - 1))/self%width(cell)
  end function in_cells

  !> The reverse of in_cells.
  pure function in_metres(self, s) result(x)
    class(axis_t), intent(in) :: self
    real(wp), intent(in) :: s
    real(wp) :: x

    integer :: cell, turns
    real(wp) :: inside

    inside = s
    turns = 0
    if (self%periodic) then
      turns = floor(s/self%n)
      inside = s - turns*self%n
    end if
    cell = min(max(floor(inside) + 1, 1), self%n)
    x = turns*(self%upper - self%lower) + self%face(cell - 1) + (inside - (cell - 1))*self%width(cell)
  end function in_metres

  !> The cell that holds a place, or the one nearest to it, by bisection.
  pure function cell_of(self, x) result(cell)
    class(axis_t), intent(in) :: self
    real(wp), intent(in) :: x  !< [m]
    integer :: cell

    integer :: above, middle

    cell = 1
    above = self%n + 1
    do while (above - cell > 1)
      middle = (cell + above)/2
      if (x >= self%face(middle - 1)) cell = middle
      if (.not. x >= self%face(middle - 1)) above = middle
    end do
  end function cell_of

end module grid_axis
