!> A list of pairs dealt by their laws, so that a sweep over one part has one law and looks nothing up.
!>
!> The parts are what sweeps read and where slips are while there are several laws. The list they were dealt from stays as it
!> was but for its slips, which `gather` brings up to date.
module contact_parts
  use contact_list, only: contact_list_t
  use kinds, only: wp
  implicit none
  private
  public :: deal, gather

contains

  !> Deal the entries of a list, in their order, by the law of each pair of materials.
  pure subroutine deal(list, material, number, parts)
    type(contact_list_t), intent(in) :: list
    integer, intent(in) :: material(:)                     !< of each column, ghosts included
    integer, intent(in) :: number(0:,0:)                   !< of the law, by both materials
    type(contact_list_t), allocatable, intent(inout) :: parts(:)  !< one for each law

    integer :: next(size(parts)), k, c

    do c = 1, size(parts)
      parts(c)%with_history = list%with_history
      parts(c)%rows = list%rows
      call make_room(parts(c), count_entries(list, material, number, c))
    end do
    next = 0
    do k = 1, list%entries
      c = number(material(list%row(k)), material(list%partner(k)))
      next(c) = next(c) + 1
      parts(c)%row(next(c)) = list%row(k)
      parts(c)%partner(next(c)) = list%partner(k)
      if (list%with_history) parts(c)%slip(:, next(c)) = list%slip(:, k)
    end do
  end subroutine deal

  pure function count_entries(list, material, number, law) result(n)
    type(contact_list_t), intent(in) :: list
    integer, intent(in) :: material(:), number(0:,0:), law
    integer :: n

    integer :: k

    n = 0
    do k = 1, list%entries
      n = n + merge(1, 0, number(material(list%row(k)), material(list%partner(k))) == law)
    end do
  end function count_entries

  !> Slips of the parts back to the entries they were dealt from.
  pure subroutine gather(parts, material, number, list)
    type(contact_list_t), intent(in) :: parts(:)
    integer, intent(in) :: material(:), number(0:,0:)  !< as they were dealt
    type(contact_list_t), intent(inout) :: list

    integer :: next(size(parts)), k, c

    if (.not. list%with_history) return
    next = 0
    do k = 1, list%entries
      c = number(material(list%row(k)), material(list%partner(k)))
      next(c) = next(c) + 1
      list%slip(:, k) = parts(c)%slip(:, next(c))
    end do
  end subroutine gather

  pure subroutine make_room(part, entries)
    type(contact_list_t), intent(inout) :: part
    integer, intent(in) :: entries

    integer :: room

    part%entries = entries
    if (allocated(part%row)) then
      if (size(part%row) >= entries) return
      deallocate (part%row, part%partner)
      if (part%with_history) deallocate (part%slip)
    end if
    room = entries + entries/8 + 8
    allocate (part%row(room), part%partner(room))
    if (part%with_history) allocate (part%slip(4, room))
  end subroutine make_room

end module contact_parts
