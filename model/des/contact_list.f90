!> Pairs that touch or may touch before the list is made again.
!>
!> Row i holds the partners of parcel i: own parcels with a higher column, then ghosts. They are entries first(i)
!> to first(i+1)-1. Loops over all pairs read the row from `row`: an inner loop over a few partners ends at
!> another place each time, which no processor foresees (14 % of the contact loop).
!>
!> With friction every entry has its slip, oriented from the row's parcel to the partner, and the number of the
!> last step in which the pair touched: a slip older than one step is that of an earlier contact and counts as
!> none.
module contact_list
  use kinds, only: wp
  implicit none
  private
  public :: contact_list_t, never

  real(wp), parameter :: never = -1.0_wp  !< the last touch of a pair that has not touched yet

  type :: contact_list_t
    logical :: with_history = .false.
    logical :: with_angles = .false.      !< whether contacts remember how far they have rolled
    integer :: rows = 0                   !< own parcels, or parcels near walls
    integer :: entries = 0                !< entries in use
    integer, allocatable :: first(:)      !< (rows+1 at least)
    integer, allocatable :: row(:)        !< (entries at least) the row of each entry
    integer, allocatable :: partner(:)    !< (entries at least) column of the partner
    real(wp), allocatable :: slip(:,:)    !< (4, entries at least) 1:3 tangential slip [m], 4 step of last touch
    real(wp), allocatable :: angle(:,:)   !< (3, entries at least) with the rolling spring: angle rolled [rad]
  contains
    procedure :: start
    procedure :: reserve
    procedure :: note_rows
    procedure :: clear_history
    procedure :: memory_of
    procedure :: remind
  end type contact_list_t

contains

  !> An empty list of the given number of rows.
  pure subroutine start(self, rows)
    class(contact_list_t), intent(inout) :: self
    integer, intent(in) :: rows

    self%rows = rows
    self%entries = 0
    if (allocated(self%first)) then
      if (size(self%first) <= rows) deallocate (self%first)
    end if
    if (.not. allocated(self%first)) allocate (self%first(rows + rows/4 + 2))
    self%first(1) = 1
    if (.not. allocated(self%partner)) allocate (self%partner(6*rows + 64))
  end subroutine start

  !> Room for at least so many entries in `partner`.
  pure subroutine reserve(self, entries)
    class(contact_list_t), intent(inout) :: self
    integer, intent(in) :: entries

    integer, allocatable :: larger(:)

    if (entries <= size(self%partner)) return
    allocate (larger(entries + entries/4))
    larger(1:self%entries) = self%partner(1:self%entries)
    call move_alloc(larger, self%partner)
  end subroutine reserve

  !> Once all rows are there: which row each entry is in.
  pure subroutine note_rows(self)
    class(contact_list_t), intent(inout) :: self

    integer :: i

    if (allocated(self%row)) then
      if (size(self%row) < self%entries) deallocate (self%row)
    end if
    if (.not. allocated(self%row)) allocate (self%row(self%entries + self%entries/8 + 8))
    do i = 1, self%rows
      self%row(self%first(i):self%first(i + 1) - 1) = i
    end do
  end subroutine note_rows

  !> Nothing has touched yet.
  subroutine clear_history(self)
    class(contact_list_t), intent(inout) :: self

    if (.not. self%with_history) return
    if (allocated(self%slip)) then
      if (size(self%slip, 2) < self%entries) deallocate (self%slip)
    end if
    if (.not. allocated(self%slip)) allocate (self%slip(4, self%entries + self%entries/8 + 8))
    self%slip(1:3, 1:self%entries) = 0.0_wp
    self%slip(4, 1:self%entries) = never
    if (.not. self%with_angles) return
    if (allocated(self%angle)) then
      if (size(self%angle, 2) < self%entries) deallocate (self%angle)
    end if
    if (.not. allocated(self%angle)) allocate (self%angle(3, size(self%slip, 2)))
    self%angle(:, 1:self%entries) = 0.0_wp
  end subroutine clear_history

  !> What an entry remembers beside the step of its last touch: the slip and, if there is one, the angle.
  pure function memory_of(self, entry) result(memory)
    class(contact_list_t), intent(in) :: self
    integer, intent(in) :: entry
    real(wp) :: memory(merge(6, 3, self%with_angles))

    memory(1:3) = self%slip(1:3, entry)
    if (self%with_angles) memory(4:6) = self%angle(:, entry)
  end function memory_of

  !> Give it back.
  pure subroutine remind(self, entry, memory, step)
    class(contact_list_t), intent(inout) :: self
    integer, intent(in) :: entry
    real(wp), intent(in) :: memory(:)  !< as `memory_of`
    real(wp), intent(in) :: step       !< of the last touch

    self%slip(:, entry) = [memory(1:3), step]
    if (self%with_angles) self%angle(:, entry) = memory(4:6)
  end subroutine remind

end module contact_list
