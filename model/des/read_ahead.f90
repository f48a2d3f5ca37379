!> Which parcels a stretch of rows is the first to need, so that they are read in the order of memory before.
!>
!> A sweep over pairs waits for memory where it comes to a partner for the first time: partners are here and there, and no
!> processor foresees where. Read one behind the other they make it wait less. Not so where those that touch are selected first,
!> which reads the partners with little else to do (see close_pairs): there reading ahead costs 14 %.
module read_ahead
  use contact_list, only: contact_list_t, stretch_rows
  use kinds, only: wp
  use parcels, only: parcels_t
  implicit none
  private
  public :: read_ahead_t

  type :: read_ahead_t
    integer, allocatable, private :: column(:)   !< of one stretch after the other, ascending in each
    integer, allocatable, private :: last(:)     !< (0:stretches) place in `column` where each ends
    real(wp), private :: largest = 0.0_wp        !< of all that was read; kept, or compilers would leave the reading out
  contains
    procedure :: note
    procedure :: read_stretch
  end type read_ahead_t

contains

  !> Find the columns of each stretch for a new list.
  pure subroutine note(self, list, parcels)
    class(read_ahead_t), intent(inout) :: self
    type(contact_list_t), intent(in) :: list
    type(parcels_t), intent(in) :: parcels

    integer :: stretch(parcels%n_all()), next(0:stretch_of(parcels%n)), c, k

    stretch = size(next)
    do c = 1, parcels%n
      stretch(c) = stretch_of(c)
    end do
    do k = 1, list%entries
      associate (partner => stretch(list%partner(k)))
        partner = min(partner, stretch_of(list%row(k)))
      end associate
    end do
    if (allocated(self%column)) deallocate (self%column, self%last)
    allocate (self%column(parcels%n_all()), self%last(0:ubound(next, 1)))
    self%last = 0
    do c = 1, size(stretch)
      if (stretch(c) < size(next)) self%last(stretch(c)) = self%last(stretch(c)) + 1
    end do
    do k = 1, ubound(next, 1)
      self%last(k) = self%last(k) + self%last(k - 1)
    end do
    next(1:) = self%last(:ubound(next, 1) - 1)
    do c = 1, size(stretch)
      if (stretch(c) == size(next)) cycle
      next(stretch(c)) = next(stretch(c)) + 1
      self%column(next(stretch(c))) = c
    end do
  end subroutine note

  !> The stretch a row is in.
  elemental function stretch_of(row)
    integer, intent(in) :: row
    integer :: stretch_of

    stretch_of = (row + stretch_rows - 1)/stretch_rows
  end function stretch_of

  !> Read what the stretch that begins with a row is the first to need.
  pure subroutine read_stretch(self, row, parcels)
    class(read_ahead_t), intent(inout) :: self
    integer, intent(in) :: row
    type(parcels_t), intent(in) :: parcels

    associate (k => stretch_of(row))
      call read_columns(self%column(self%last(k - 1) + 1:self%last(k)), size(parcels%state, 1), parcels%state, self%largest)
    end associate
  end subroutine read_stretch

  !> A number of each line of memory that a column has. Vectors would gather them, more slowly.
  pure subroutine read_columns(column, rows, state, largest)
    integer, intent(in) :: column(:), rows
    real(wp), intent(in) :: state(rows, *)
    real(wp), intent(inout) :: largest

    integer :: k

    !GCC$ novector
    do k = 1, size(column)
      largest = max(largest, state(1, column(k)), state(rows, column(k)))
    end do
  end subroutine read_columns

end module read_ahead
