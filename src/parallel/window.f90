!> The gas cells that the parcels of this rank can touch.
!>
!> A parcel touches the eight cells whose centres surround it. The window is the smallest rectangular range of cells
!> that holds those of every place that a parcel of this rank can be at, all places counted in cells. Along a periodic
!> direction an index may lie below 1 or above the number of cells: it is then an image of a cell at the other end.
!> Of the range only the cells marked `wanted` are ever filled; fields over a window are (components, cells), its
!> cells counted from 1 with x fastest.
module window
  use kinds, only: wp
  implicit none
  private
  public :: window_t, new_window, range_of_cells

  real(wp), parameter :: round_off = 1.0e-9_wp  !< of a cell

  type :: window_t
    integer :: grid(3)                 !< cells of the whole grid
    logical :: periodic(3)             !< whether opposite faces of the grid are joined
    integer :: lo(3), hi(3)            !< first and last cell, counted in the whole grid from 1; at least two cells
    integer :: n(3)                    !< hi - lo + 1, or 0 where the rank has no tile
    logical, allocatable :: wanted(:)  !< (cells) whether a parcel can touch the cell
  contains
    procedure :: cells
    procedure :: cell_at
  end type window_t

contains

  !> The window of a set of boxes of space.
  pure function new_window(grid, periodic, corners) result(window)
    integer, intent(in) :: grid(3)           !< cells of the whole grid
    logical, intent(in) :: periodic(3)
    real(wp), intent(in) :: corners(:,:,:)   !< (3,2,boxes) lower and upper corner of each, counted in cells
    type(window_t) :: window

    integer :: i, lo(3, size(corners, 3)), hi(3, size(corners, 3))

    window%grid = grid
    window%periodic = periodic
    do i = 1, size(corners, 3)
      call touched(window, corners(:, :, i), lo(:, i), hi(:, i))
    end do
    if (size(corners, 3) > 0) then
      window%lo = minval(lo, 2)
      window%hi = max(maxval(hi, 2), window%lo + 1)
    else
      window%lo = 1
      window%hi = 0
    end if
    window%n = window%hi - window%lo + 1
    allocate (window%wanted(product(window%n)), source=.false.)
    do i = 1, size(corners, 3)
      call mark(window%n, lo(:, i) - window%lo + 1, hi(:, i) - window%lo + 1, window%wanted)
    end do
  end function new_window

  !> The window of all cells of a range, which no parcel has to touch.
  pure function range_of_cells(grid, periodic, lo, hi) result(window)
    integer, intent(in) :: grid(3)         !< cells of the whole grid
    logical, intent(in) :: periodic(3)
    integer, intent(in) :: lo(3), hi(3)    !< first and last cell; images beyond the grid where it is periodic
    type(window_t) :: window

    window%grid = grid
    window%periodic = periodic
    window%lo = lo
    window%hi = hi
    window%n = hi - lo + 1
    allocate (window%wanted(product(window%n)), source=.true.)
  end function range_of_cells

  !> The range of cells a parcel in a box can touch.
  pure subroutine touched(window, corners, lo, hi)
    type(window_t), intent(in) :: window
    real(wp), intent(in) :: corners(3, 2)  !< lower and upper corner, counted in cells
    integer, intent(out) :: lo(3), hi(3)

    ! The centre of cell c is at c - 1/2.
    lo = floor(corners(:, 1) + 0.5_wp - round_off)
    hi = floor(corners(:, 2) + 0.5_wp + round_off) + 1
    where (.not. window%periodic)
      lo = min(max(lo, 1), window%grid)
      hi = min(max(hi, 1), window%grid)
    end where
  end subroutine touched

  pure subroutine mark(n, lo, hi, wanted)
    integer, intent(in) :: n(3), lo(3), hi(3)
    logical, intent(inout) :: wanted(n(1), n(2), n(3))

    wanted(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3)) = .true.
  end subroutine mark

  !> How many cells the window has, wanted or not.
  pure function cells(self)
    class(window_t), intent(in) :: self
    integer :: cells

    cells = product(self%n)
  end function cells

  !> The cell of the whole grid that the given cell of the window is, or is an image of.
  pure function cell_at(self, index) result(cell)
    class(window_t), intent(in) :: self
    integer, intent(in) :: index  !< from 1, x fastest
    integer :: cell(3)

    integer :: rest

    rest = index - 1
    cell(1) = modulo(rest, self%n(1))
    rest = rest/self%n(1)
    cell(2:3) = [modulo(rest, self%n(2)), rest/self%n(2)]
    cell = modulo(cell + self%lo - 1, self%grid) + 1
  end function cell_at

end module window
