!> A list of pairs dealt by their laws, so that a sweep over one part has one law and looks nothing up.
!>
!> The parts are what sweeps read and where slips are while there are several laws. The list they were dealt from stays as it
!> was but for its slips, which `gather` brings up to date.
module contact_parts
  use contact_laws, only: contact_laws_t
  use contact_list, only: contact_list_t
  use kinds, only: wp
  implicit none
  private
  public :: deal, gather

contains

  !> Deal the entries of a list, in their order, by the law of each pair of powders.
  pure subroutine deal(list, laws, powder, parts)
    type(contact_list_t), intent(in) :: list
    type(contact_laws_t), intent(in) :: laws
    integer, intent(in) :: powder(:)                     !< of each column, ghosts included
    type(contact_list_t), intent(inout) :: parts(:)      !< one for each law

    integer :: number(list%entries), next(size(parts)), k, c

    number = numbers(list, laws, powder)
    do c = 1, size(parts)
      parts(c)%with_history = list%with_history
      parts(c)%rows = list%rows
      call make_room(parts(c), count(number == c))
    end do
    next = 0
    do k = 1, list%entries
      c = number(k)
      next(c) = next(c) + 1
      parts(c)%row(next(c)) = list%row(k)
      parts(c)%partner(next(c)) = list%partner(k)
      if (list%with_history) parts(c)%slip(:, next(c)) = list%slip(:, k)
    end do
  end subroutine deal

  !> Slips of the parts back to the entries they were dealt from.
  pure subroutine gather(parts, laws, powder, list)
    type(contact_list_t), intent(in) :: parts(:)
    type(contact_laws_t), intent(in) :: laws
    integer, intent(in) :: powder(:)  !< as they were dealt
    type(contact_list_t), intent(inout) :: list

    integer :: number(list%entries), next(size(parts)), k, c

    if (.not. list%with_history) return
    number = numbers(list, laws, powder)
    next = 0
    do k = 1, list%entries
      c = number(k)
      next(c) = next(c) + 1
      list%slip(:, k) = parts(c)%slip(:, next(c))
    end do
  end subroutine gather

  !> Of the law of each entry.
  pure function numbers(list, laws, powder)
    type(contact_list_t), intent(in) :: list
    type(contact_laws_t), intent(in) :: laws
    integer, intent(in) :: powder(:)
    integer :: numbers(list%entries)

    integer :: material(size(powder)), k

    material = laws%material(powder)
    do k = 1, list%entries
      numbers(k) = laws%pair_number(material(list%row(k)), material(list%partner(k)))
    end do
  end function numbers

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
