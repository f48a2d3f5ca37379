!> The slips of all contacts, while the list that held them is made anew.
!>
!> A record belongs to a parcel of mine; it names the partner by its column as long as that is mine as well, and
!> by its id otherwise. A pair whose partners are mine has one record; a pair with a ghost has one on either side.
!> Walls are partners with the id -face, as the chamber numbers them. Where contacts have angles rolled, these stand below
!> the slips: like them they are the opposite as seen from the partner.
module contact_history
  use close_pairs, only: close_pairs_t
  use contact_list, only: contact_list_t
  use kinds, only: wp, i8
  use parcels, only: parcels_t
  use walls, only: wall_list_t
  implicit none
  private
  public :: history_t

  type :: history_t
    integer :: n = 0
    integer :: rows = 3                     !< of a slip; 6 with angles
    integer, allocatable :: own(:)          !< (n at least) column of my parcel
    integer, allocatable :: other(:)        !< column of the partner, 0 if it is not mine
    integer(i8), allocatable :: other_id(:)  !< id of the partner, where `other` is 0
    real(wp), allocatable :: slip(:,:)      !< (rows, n at least) from my parcel to the partner, 1:3 [m], 4:6 [rad]
  contains
    procedure :: collect
    procedure :: follow
    procedure :: restore
    procedure :: append
    procedure :: put
    procedure :: drop
    procedure :: clear
  end type history_t

contains

  subroutine clear(self)
    class(history_t), intent(inout) :: self

    self%n = 0
    if (.not. allocated(self%own)) call resize(self, 64)
  end subroutine clear

  !> Record all contacts of the last step.
  subroutine collect(self, pairs, walls, parcels, step)
    class(history_t), intent(inout) :: self
    type(close_pairs_t), intent(in) :: pairs
    type(wall_list_t), intent(in) :: walls
    type(parcels_t), intent(in) :: parcels
    real(wp), intent(in) :: step  !< number of the last step, for walls

    integer :: i, j, k, w

    call self%clear()
    if (size(self%own) < pairs%n + walls%entries) call resize(self, pairs%n + walls%entries)
    do k = 1, pairs%n
      if (.not. pairs%remembers(k)) cycle
      i = pairs%i(k)
      j = pairs%j(k)
      if (j <= parcels%n) then
        call self%append(i, j, 0_i8, pairs%memory_of(k))
      else
        call self%append(i, 0, parcels%id(j), pairs%memory_of(k))
      end if
    end do
    do w = 1, walls%entries
      if (walls%slip(4, w) < step - 0.5_wp) cycle
      call self%append(walls%parcel(w), 0, int(-walls%face(w), i8), walls%memory_of(w))
    end do
  end subroutine collect

  subroutine append(self, own, other, other_id, slip)
    class(history_t), intent(inout) :: self
    integer, intent(in) :: own, other
    integer(i8), intent(in) :: other_id
    real(wp), intent(in) :: slip(:)  !< (rows, or more that do not count)

    if (self%n == size(self%own)) call resize(self, 2*self%n)
    self%n = self%n + 1
    call self%put(self%n, own, other, other_id, slip)
  end subroutine append

  !> Write record m.
  pure subroutine put(self, m, own, other, other_id, slip)
    class(history_t), intent(inout) :: self
    integer, intent(in) :: m, own, other
    integer(i8), intent(in) :: other_id
    real(wp), intent(in) :: slip(:)  !< (rows, or more that do not count)

    self%own(m) = own
    self%other(m) = other
    self%other_id(m) = other_id
    self%slip(:, m) = slip(:self%rows)
  end subroutine put

  !> Forget record m; the last takes its place.
  pure subroutine drop(self, m)
    class(history_t), intent(inout) :: self
    integer, intent(in) :: m

    associate (last => self%n)
      call self%put(m, self%own(last), self%other(last), self%other_id(last), (self%slip(:, last)))
    end associate
    self%n = self%n - 1
  end subroutine drop

  !> Parcels have changed their columns: place(old column) is the new one.
  pure subroutine follow(self, place)
    class(history_t), intent(inout) :: self
    integer, intent(in) :: place(:)

    integer :: m

    do m = 1, self%n
      self%own(m) = place(self%own(m))
      if (self%other(m) > 0) self%other(m) = place(self%other(m))
    end do
  end subroutine follow

  !> Give the slips back to the entries of the new lists. All listed pairs are close.
  subroutine restore(self, list, pairs, walls, parcels, step)
    class(history_t), intent(in) :: self
    type(contact_list_t), intent(in) :: list
    type(close_pairs_t), intent(inout) :: pairs
    type(wall_list_t), intent(inout) :: walls
    type(parcels_t), intent(in) :: parcels
    real(wp), intent(in) :: step  !< number of the last step

    integer :: first_wall(parcels%n), next_wall(walls%entries), m, w, k, i, j
    real(wp) :: memory(6)

    memory = 0.0_wp
    first_wall = 0
    do w = walls%entries, 1, -1
      next_wall(w) = first_wall(walls%parcel(w))
      first_wall(walls%parcel(w)) = w
    end do
    do m = 1, self%n
      i = self%own(m)
      j = self%other(m)
      memory(:self%rows) = self%slip(:, m)
      if (j > 0) then
        k = entry_of(list, min(i, j), max(i, j))
        if (k > 0) then
          call pairs%remind(k, merge(1.0_wp, -1.0_wp, i < j)*memory)
        else
          ! A periodic face has come between the two: each now touches the image of the other.
          call restore_image(list, pairs, parcels, i, parcels%id(j), memory)
          call restore_image(list, pairs, parcels, j, parcels%id(i), -memory)
        end if
      else if (self%other_id(m) > 0) then
        call restore_image(list, pairs, parcels, i, self%other_id(m), memory)
      else
        w = first_wall(i)
        do while (w > 0)
          if (walls%face(w) == -self%other_id(m)) call walls%remind(w, memory, step)
          w = next_wall(w)
        end do
      end if
    end do
  end subroutine restore

  !> The entry of partner j in row i, 0 if there is none.
  pure function entry_of(list, i, j) result(entry)
    type(contact_list_t), intent(in) :: list
    integer, intent(in) :: i, j
    integer :: entry

    do entry = list%first(i), list%first(i + 1) - 1
      if (list%partner(entry) == j) return
    end do
    entry = 0
  end function entry_of

  !> Give what is remembered to the entry of row i whose partner has the given id.
  pure subroutine restore_image(list, pairs, parcels, i, id, memory)
    type(contact_list_t), intent(in) :: list
    type(close_pairs_t), intent(inout) :: pairs
    type(parcels_t), intent(in) :: parcels
    integer, intent(in) :: i
    integer(i8), intent(in) :: id
    real(wp), intent(in) :: memory(6)

    integer :: k

    do k = list%first(i), list%first(i + 1) - 1
      if (parcels%id(list%partner(k)) == id) call pairs%remind(k, memory)
    end do
  end subroutine restore_image

  subroutine resize(self, capacity)
    class(history_t), intent(inout) :: self
    integer, intent(in) :: capacity

    type(history_t) :: larger
    integer :: n

    n = self%n
    allocate (larger%own(capacity), larger%other(capacity), larger%other_id(capacity), larger%slip(self%rows, capacity))
    if (n > 0) then
      larger%own(1:n) = self%own(1:n)
      larger%other(1:n) = self%other(1:n)
      larger%other_id(1:n) = self%other_id(1:n)
      larger%slip(:, 1:n) = self%slip(:, 1:n)
    end if
    call move_alloc(larger%own, self%own)
    call move_alloc(larger%other, self%other)
    call move_alloc(larger%other_id, self%other_id)
    call move_alloc(larger%slip, self%slip)
  end subroutine resize

end module contact_history
