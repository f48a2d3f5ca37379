!> Copies of parcels near the border of another rank's tiles, or near a periodic face.
!>
!> Most of them touch nobody before close pairs are chosen anew. So those in close pairs are watched, and kept up to date step by
!> step; the others follow when pairs are chosen.
module ghosts
  use communicator, only: communicator_t
  use kinds, only: wp, i8
  use parcels, only: parcels_t
  use route, only: route_t
  use tiles, only: tiles_t, most_images
  implicit none
  private
  public :: ghosts_t

  integer, parameter :: all_rows = 4, moving_rows = 3  !< of every four of `state`: the last is one that does not change

  type :: ghosts_t
    logical :: needed = .false.  !< whether there is another rank or a periodic face
    logical, allocatable :: near(:)  !< (n) whether a ghost may be near this parcel of mine
    type(route_t), private :: route
  contains
    procedure :: invite
    procedure :: watch
    procedure :: refresh
  end type ghosts_t

contains

  !> Find out who must see my parcels, and receive all of others' that I must see.
  subroutine invite(self, tiles, range, parcels, with_powder)
    class(ghosts_t), intent(inout) :: self
    type(tiles_t), intent(in) :: tiles
    real(wp), intent(in) :: range           !< of contacts [m]
    type(parcels_t), intent(inout) :: parcels
    logical, intent(in) :: with_powder      !< whether contacts depend on the powder

    integer, allocatable :: destination(:), column(:)
    real(wp), allocatable :: shift(:,:)
    integer(i8), allocatable :: ids(:,:)

    parcels%n_ghost = 0
    self%near = spread(.false., 1, parcels%n)
    self%needed = tiles%comm%size > 1 .or. any(tiles%periodic)
    if (.not. self%needed) return
    call find_images(tiles, range, parcels, destination, column, shift)
    self%near(column) = .true.  ! nobody else is in range of a tile with a ghost
    call self%route%set(tiles%comm, destination, column, shift)
    call parcels%reserve(parcels%n + self%route%n_received)
    parcels%n_ghost = self%route%n_received
    allocate (ids(1, parcels%n_ghost))
    call self%route%send(reshape(parcels%id(column), [1, size(column)]), ids)
    parcels%id(parcels%n + 1:parcels%n_all()) = ids(1, :)
    if (with_powder) then
      call self%route%send(reshape(int(parcels%powder(column), i8), [1, size(column)]), ids)
      parcels%powder(parcels%n + 1:parcels%n_all()) = int(ids(1, :))
    end if
    call self%route%refresh(parcels%state, parcels%n + 1, all_rows, watched=.false.)
  end subroutine invite

  subroutine find_images(tiles, range, parcels, destination, column, shift)
    type(tiles_t), intent(in) :: tiles
    real(wp), intent(in) :: range
    type(parcels_t), intent(in) :: parcels
    integer, allocatable, intent(out) :: destination(:), column(:)  !< (images)
    real(wp), allocatable, intent(out) :: shift(:,:)                !< (3, images) [m]

    integer :: rank(most_images), count, n, i
    real(wp) :: way(3, most_images)

    allocate (destination(64), column(64), shift(3, 64))
    n = 0
    do i = 1, parcels%n
      call tiles%images(parcels%state(1:3, i), range, rank, way, count)
      if (count == 0) cycle
      if (n + count > size(column)) then
        destination = [destination, destination]
        column = [column, column]
        shift = reshape([shift, shift], [3, size(column)])
      end if
      destination(n + 1:n + count) = rank(1:count)
      shift(:, n + 1:n + count) = way(:, 1:count)
      column(n + 1:n + count) = i
      n = n + count
    end do
    destination = destination(1:n)
    column = column(1:n)
    shift = shift(:, 1:n)
  end subroutine find_images

  !> From now on the ghosts among these columns are those that others may touch. All ranks take part.
  subroutine watch(self, parcels, touched)
    class(ghosts_t), intent(inout) :: self
    type(parcels_t), intent(in) :: parcels
    logical, intent(in) :: touched(:)  !< (own parcels and ghosts)

    if (self%needed) call self%route%watch(touched(parcels%n + 1:parcels%n_all()))
  end subroutine watch

  !> Bring positions, velocities and spins of all ghosts up to date, or of those watched.
  subroutine refresh(self, parcels, watched)
    class(ghosts_t), intent(inout) :: self
    type(parcels_t), intent(inout) :: parcels
    logical, intent(in) :: watched

    if (self%needed) call self%route%refresh(parcels%state, parcels%n + 1, moving_rows, watched)
  end subroutine refresh

end module ghosts
